// Irradiance of a receiver by a light of radiance 1, see radiometry.py.

// n . (a x b) / |a x b| times the angle between a and b; `edge` is b - a without the loss of the difference.
float edge_sum(vec3 a, vec3 b, vec3 edge, vec3 n) {
    vec3 c = cross(a, edge);
    float sine = length(c), cosine = dot(a, b);
    return dot(n, c) * (sine > 1e-6 * abs(cosine) ? atan(sine, cosine) / sine : 1.0 / max(abs(cosine), 1e-30));
}

vec2 polygon_corner(Light light, int k) {
    if (light.shape == 0) return vec2(k == 1 || k == 2 ? 0.5 : -0.5, k >= 2 ? 0.5 : -0.5);
    float angle = 6.283185307179586 * float(k) / float(ELLIPSE_CORNERS);
    return 0.5 * ELLIPSE_SCALE * vec2(cos(angle), sin(angle));
}

float area_irradiance(Light light, vec3 p, vec3 n) {
    vec3 to = light.position - p;
    float ahead = -dot(light.normal, to);
    if (ahead <= 0.0) return 0.0;
    vec3 u = light.axis_u, v = light.axis_v;
    float square = dot(to, to), size = max(dot(u, u), dot(v, v));
    if (size < 2.5e-4 * square) { // as small as this it is a point: the edges would cancel
        float area = length(cross(u, v)) * (light.shape == 0 ? 1.0 : 0.7853981633974483);
        return area * ahead * max(dot(n, to), 0.0) / (square * square);
    }
    int corners = light.shape == 0 ? 4 : ELLIPSE_CORNERS;
    vec2 at = polygon_corner(light, corners - 1);
    vec3 a = to + at.x * u + at.y * v;
    float height = dot(n, a), sum = 0.0;
    vec3 leaves = vec3(0.0), enters = vec3(0.0);
    bool cut = false;
    for (int k = 0; k < corners; ++k) {
        vec2 next = polygon_corner(light, k);
        vec3 b = to + next.x * u + next.y * v;
        vec3 edge = (next.x - at.x) * u + (next.y - at.y) * v;
        float next_height = dot(n, b);
        if (height > 0.0 || next_height > 0.0) {
            float t = height / (height - next_height);
            vec3 first = height > 0.0 ? a : a + t * edge, last = next_height > 0.0 ? b : a + t * edge;
            if (height <= 0.0) enters = first;
            if (next_height <= 0.0) leaves = last;
            cut = cut || height <= 0.0 || next_height <= 0.0;
            sum += edge_sum(first, last, height > 0.0 && next_height > 0.0 ? edge : last - first, n);
        }
        at = next;
        a = b;
        height = next_height;
    }
    if (cut) sum += edge_sum(leaves, enters, enters - leaves, n);
    return 0.5 * abs(sum);
}
