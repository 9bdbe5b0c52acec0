// Irradiance of a parallelogram of radiance 1: Lambert's sum over its edges above the receiver's horizon, see
// radiometry.py.
#include "maths/atan2.glsl"

// A parallelogram of sides u and v about `centre`, clipped by the horizon of a receiver at the origin with normal n.
struct ClippedParallelogram {
    vec3 centre, u, v, n;
    vec3 corner, exit, entry; // from the centre: next corner; where the boundary leaves and enters the horizon
    bool clipped;
};

ClippedParallelogram clip_parallelogram(vec3 centre, vec3 u, vec3 v, vec3 n) {
    return ClippedParallelogram(centre, u, v, n, -0.5 * (u + v), vec3(0.0), vec3(0.0), false);
}

// Edge k clipped by the horizon: its start and vector. Edge 4 is along the horizon. False if the edge does not exist.
bool next_clipped_edge(inout ClippedParallelogram o, int k, out vec3 start, out vec3 edge) {
    vec3 full_edge = (k & 1) == 0 ? o.u : o.v;
    if (k >= 2) full_edge = -full_edge;
    start = o.corner;
    edge = full_edge;
    if (k == 4) {
        start = o.exit;
        edge = o.entry - o.exit;
        return o.clipped;
    }
    float height = dot(o.n, o.centre + o.corner), next = dot(o.n, o.centre + o.corner + full_edge);
    if ((height > 0.0) != (next > 0.0)) {
        edge *= height / (height - next);
        if (height > 0.0) {
            o.exit = o.corner + edge;
        } else {
            o.entry = start = o.corner + edge;
            edge = full_edge - edge;
        }
        o.clipped = true;
    }
    o.corner += full_edge;
    return max(height, next) > 0.0;
}

// A small light: Gauss-Legendre quadrature of 2 x 2 points. `normal`: of its plane.
float small_polygon(vec3 centre, vec3 u, vec3 v, vec3 n, vec3 normal, int points) {
    float sum = 0.0;
    for (int k = 0; k < points; ++k) {
        vec3 p = centre + 0.28867513459 * (((k & 1) == 0 ? u : -u) + ((k & 2) == 0 ? v : -v));
        float square = dot(p, p);
        sum += max(dot(n, p), 0.0) / (square * square);
    }
    return 0.25 * sum * abs(dot(normal, centre) * dot(normal, cross(u, v)));
}

// `centre`: from the receiver to the light; u, v: sides; n: the receiver's normal; `normal`: the light's.
float polygon_irradiance(vec3 centre, vec3 u, vec3 v, vec3 n, vec3 normal) {
    float height = dot(n, centre), amplitude = 0.5 * (abs(dot(n, u)) + abs(dot(n, v)));
    float square = dot(centre, centre), uu = dot(u, u), vv = dot(v, v);
    // The terms of a small light's edges cancel. If the horizon clips the light, the quadrature is less accurate: it is
    // then used only for even smaller lights.
    bool small = max(uu, vv) < 2e-3 * square && (height >= amplitude || uu * vv < 1e-12 * square * square);
    float sum = small_polygon(centre, u, v, n, normal, small ? 4 : 0);
    if (small) return sum;
    ClippedParallelogram o = clip_parallelogram(centre, u, v, n);
    for (int k = 0; k < 4; ++k) {
        vec3 start, edge;
        if (!next_clipped_edge(o, k, start, edge)) continue;
        vec3 a = centre + start, c = cross(a, edge); // cross(a, b) would round a small light's edge away
        float sine = length(c);
        sum += dot(n, c) * (atan2_accurate(sine, dot(a, a + edge)) / max(sine, 1e-30));
    }
    vec3 a = centre + o.exit, b = centre + o.entry; // along the horizon n . (a x b) / |a x b| is 1
    float horizon = o.clipped ? atan2_accurate(length(cross(a, o.entry - o.exit)), dot(a, b)) : 0.0;
    return 0.5 * max(horizon + (dot(normal, cross(u, v)) < 0.0 ? sum : -sum), 0.0);
}
