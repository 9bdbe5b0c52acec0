// Irradiance by a parallelogram of radiance 1: Lambert's edge sum above the receiver's horizon, see radiometry.py.
#include "maths/atan2.glsl"

// A parallelogram whose sides are u and v about `centre`, which is seen from the origin, cut by the horizon of n.
struct ClippedParallelogram {
    vec3 centre, u, v, n;
    vec3 at, leaves, enters; // from the centre: the next corner, and where the rim crosses the horizon
    bool cut;
};

ClippedParallelogram clip_parallelogram(vec3 centre, vec3 u, vec3 v, vec3 n) {
    return ClippedParallelogram(centre, u, v, n, -0.5 * (u + v), vec3(0.0), vec3(0.0), false);
}

// The next edge's part above the horizon, `from` and `part` on from there; the fifth edge is along the horizon.
bool next_clipped_edge(inout ClippedParallelogram o, int k, out vec3 from, out vec3 part) {
    vec3 edge = (k & 1) == 0 ? o.u : o.v;
    if (k >= 2) edge = -edge;
    from = o.at;
    part = edge;
    if (k == 4) {
        from = o.leaves;
        part = o.enters - o.leaves;
        return o.cut;
    }
    float height = dot(o.n, o.centre + o.at), next = dot(o.n, o.centre + o.at + edge);
    if ((height > 0.0) != (next > 0.0)) {
        part *= height / (height - next);
        if (height > 0.0) {
            o.leaves = o.at + part;
        } else {
            o.enters = from = o.at + part;
            part = edge - part;
        }
        o.cut = true;
    }
    o.at += edge;
    return max(height, next) > 0.0;
}

// A light seen as small: Gauss's four points. `normal`: of its plane.
float small_polygon(vec3 centre, vec3 u, vec3 v, vec3 n, vec3 normal, int points) {
    float sum = 0.0;
    for (int k = 0; k < points; ++k) {
        vec3 p = centre + 0.28867513459 * (((k & 1) == 0 ? u : -u) + ((k & 2) == 0 ? v : -v));
        float square = dot(p, p);
        sum += max(dot(n, p), 0.0) / (square * square);
    }
    return 0.25 * sum * abs(dot(normal, centre) * dot(normal, cross(u, v)));
}

// `centre`: from the receiver to the light; n: the receiver's normal.
float polygon_irradiance(vec3 centre, vec3 u, vec3 v, vec3 n, vec3 normal) {
    float middle = dot(n, centre), reach = 0.5 * (abs(dot(n, u)) + abs(dot(n, v)));
    float square = dot(centre, centre), width = dot(u, u), height = dot(v, v);
    // Seen as small its edges cancel; cut as well, the four points do worse until it is smaller still.
    bool small = max(width, height) < 2e-3 * square && (middle >= reach || width * height < 1e-12 * square * square);
    float sum = small_polygon(centre, u, v, n, normal, small ? 4 : 0);
    if (small) return sum;
    ClippedParallelogram o = clip_parallelogram(centre, u, v, n);
    for (int k = 0; k < 4; ++k) {
        vec3 from, part;
        if (!next_clipped_edge(o, k, from, part)) continue;
        vec3 a = centre + from, c = cross(a, part); // cross(a, b) would lose the edge of a small light
        float sine = length(c);
        sum += dot(n, c) * (atan2_accurate(sine, dot(a, a + part)) / max(sine, 1e-30));
    }
    vec3 a = centre + o.leaves, b = centre + o.enters; // along the horizon n . (a x b) / |a x b| is 1
    float along = o.cut ? atan2_accurate(length(cross(a, o.enters - o.leaves)), dot(a, b)) : 0.0;
    return 0.5 * max(along + (dot(normal, cross(u, v)) < 0.0 ? sum : -sum), 0.0);
}
