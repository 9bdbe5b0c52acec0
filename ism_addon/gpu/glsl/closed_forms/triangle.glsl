// Irradiance of a triangle of radiance 1: Lambert's sum over its edges above the receiver's horizon, see radiometry.py.
// It is in a loop that small triangles skip: some drivers execute both branches of an "if".
#include "maths/atan2.glsl"

// Of a point of the triangle: the receiver's cosine over the cubed distance.
float triangle_point_term(vec3 p, vec3 n) {
    float square = max(dot(p, p), 1e-37);
    return max(dot(n, p), 0.0) / (square * square);
}

// A small triangle: a quadrature of degree 2.
float small_triangle_irradiance(vec3 a, vec3 u, vec3 v, vec3 n) {
    vec3 middle = a + (u + v) / 6.0;
    float sum = triangle_point_term(middle, n) + triangle_point_term(middle + 0.5 * u, n) +
                triangle_point_term(middle + 0.5 * v, n);
    return sum * abs(dot(cross(u, v), a)) / 6.0;
}

// The corner a as seen from the receiver, the edges u and v from it to the others, and the receiver's normal n. Either
// side of the triangle emits. `small`: square of the size over the distance below which the quadrature is used.
float triangle_irradiance(vec3 a, vec3 u, vec3 v, vec3 n, float small) {
    vec3 w = v - u, middle = a + (u + v) / 3.0;
    float size = max(dot(u, u), max(dot(v, v), dot(w, w))), square = dot(middle, middle);
    vec3 heights = vec3(dot(n, a), dot(n, a + u), dot(n, a + v));
    float lowest = min(heights.x, min(heights.y, heights.z)), highest = max(heights.x, max(heights.y, heights.z));
    // The terms of a small triangle's edges cancel, as in polygon.glsl.
    bool is_small = size < small * square && (lowest >= 0.0 || size < 1e-6 * square);
    float sum = is_small ? small_triangle_irradiance(a, u, v, n) : 0.0;
    float scale = inversesqrt(max(max(size, square), 1e-37)), edge_sum = 0.0; // so that no power overflows
    vec3 corner = a * scale, edges[3] = vec3[3](u * scale, w * scale, -v * scale), exit = vec3(0.0), entry = vec3(0.0);
    bool clipped = false;
    for (int k = 0, count = is_small || highest <= 0.0 ? 0 : 4; k < count; ++k) {
        vec3 start = corner, edge = k < 3 ? edges[k] : entry - exit; // the last one is along the horizon
        float height = k < 3 ? heights[k] : 1.0, next = k < 2 ? heights[k + 1] : k == 2 ? heights.x : 1.0;
        corner += edge;
        vec3 to_horizon = edge * (height / (height - next));
        if (k == 3) start = exit;
        if (height > 0.0 && next <= 0.0) {
            exit = start + to_horizon;
            edge = to_horizon;
            clipped = true;
        }
        if (height <= 0.0 && next > 0.0) {
            entry = start + to_horizon;
            start = entry;
            edge -= to_horizon;
        }
        vec3 c = cross(start, edge); // cross(start, end) would round a small triangle's edge away
        float sine = length(c), angle = atan2_accurate(sine, dot(start, start + edge));
        bool counts = max(height, next) > 0.0 && (k < 3 || clipped);
        // n . c / |c| is 1 along the horizon, or -1 if the triangle faces the other way.
        edge_sum += counts ? dot(n, c) * (angle / max(sine, 1e-30)) : 0.0;
    }
    return sum + 0.5 * max(dot(cross(u, v), a) > 0.0 ? edge_sum : -edge_sum, 0.0);
}
