// Irradiance of lights with spread: an integral over the region of the light in the spread's cone, see radiometry.py.
// On the light's plane the cone is a disc of radius `cone` about the foot of the perpendicular from the receiver.
// Lengths are in units of the receiver's height; n is its normal in the light's space, z towards the light.
#include "maths/atan2.glsl"
#include "closed_forms/polygon.glsl"

// Integrals over the radius, from 0 to r, of (cone - r) r / (1 + r^2)^2 and of r times this.
vec2 radial_integrals(float r, float cone) {
    float s = r * r, ratio = s / (1.0 + s);
    vec2 b = 0.5 * vec2(atan2_accurate(r, 1.0) - r / (1.0 + s), log(1.0 + s) - ratio);
    if (s < 0.06) // power series: the terms above cancel
        b = s * vec2(r * (1.0 / 3.0 - s * (2.0 / 5.0 - s * (3.0 / 7.0 - s * (4.0 / 9.0 - s * (5.0 / 11.0))))),
                     s * (1.0 / 4.0 - s * (2.0 / 6.0 - s * (3.0 / 8.0 - s * (4.0 / 10.0 - s * (5.0 / 12.0))))));
    return vec2(0.5 * cone * ratio - b.x, cone * b.x - b.y);
}

// Gauss-Legendre quadrature of three points on a line at the distance d from the foot, between the angles `first` and
// `last` about the receiver. `base`: the line's point closest to the foot.
float line_integral(vec2 base, vec2 along, float d, float first, float last, vec3 n, float cone) {
    float root = sqrt(1.0 + d * d), sum = 0.0;
    for (int k = -1; k <= 1; ++k) {
        float s = root * tan(0.5 * (first + last) + 0.3872983346207417 * float(k) * (last - first));
        float square = max(d * d + s * s, 1e-20), r = sqrt(square);
        vec2 g = radial_integrals(r, cone);
        float integrand = n.z * g.x + dot(n.xy, base + s * along) / r * g.y;
        sum += (k == 0 ? 8.0 : 5.0) / 18.0 * integrand * (1.0 + square) / square;
    }
    return sum * (last - first) * d / root;
}

// A foot on an edge or a corner is moved inside by this distance. Coordinates below FOOT_ROUNDING count as 0: rounding
// errors of both edges at a corner would put the foot on different sides of it.
const float INSIDE = 1e-15, FOOT_ROUNDING = 1e-6;

float without_rounding(float x, float size) { return abs(x) <= FOOT_ROUNDING * max(size, 1.0) ? 0.0 : x; }

// An edge's term of the boundary integral, minus the arc of the cone's boundary that it replaces; 0 outside the cone.
// `encloses` becomes false where the foot is on the edge's outer side.
float cone_edge_term(vec2 from, vec2 edge, vec3 n, float cone, inout bool encloses) {
    float size = length(edge);
    vec2 along = edge / max(size, 1e-30);
    float d = without_rounding(from.x * along.y - from.y * along.x, size), start = dot(from, along);
    float chord = sqrt(max(cone * cone - d * d, 0.0)), end = min(without_rounding(start + size, size), chord);
    start = max(without_rounding(start, size), -chord);
    if (d == 0.0) {
        d = INSIDE;
        start -= INSIDE;
        end += INSIDE;
    }
    encloses = encloses && d > 0.0;
    if (start >= end) return 0.0;
    float root = sqrt(1.0 + d * d);
    float first = sign(start) * atan2_accurate(abs(start), root), last = sign(end) * atan2_accurate(abs(end), root);
    float foot = clamp(0.0, first, last); // where the derivative of r jumps
    vec2 base = d * vec2(along.y, -along.x);
    float sum = 0.0;
    if (first < foot) sum += line_integral(base, along, d, first, foot, n, cone);
    if (foot < last) sum += line_integral(base, along, d, foot, last, n, cone);
    vec2 difference = normalize(base + end * along) - normalize(base + start * along);
    vec2 full = radial_integrals(cone, cone);
    float angle = sign(d) * atan2_accurate((end - start) * abs(d), d * d + start * end);
    return sum - n.z * full.x * angle - full.y * (n.x * difference.y - n.y * difference.x);
}

// Sides u, v, with u x v > 0. `edges`: 5, or 0 if the result is not used, as some drivers execute both branches.
float spread_polygon(vec2 centre, vec2 u, vec2 v, vec3 n, float cone, int edges) {
    ClippedParallelogram o = clip_parallelogram(vec3(centre, 1.0), vec3(u, 0.0), vec3(v, 0.0), n);
    bool encloses = true;
    float sum = 0.0;
    for (int k = 0; k < edges; ++k) {
        vec3 start, edge;
        if (!next_clipped_edge(o, k, start, edge)) continue;
        sum += cone_edge_term(centre + start.xy, edge.xy, n, cone, encloses);
    }
    return (encloses ? 6.283185307179586 * n.z * radial_integrals(cone, cone).x : 0.0) + sum;
}

const float[6] GAUSS_NODES = float[6](
    0.1252334085, 0.3678314990, 0.5873179543, 0.7699026742, 0.9041172564, 0.9815606342);
const float[6] GAUSS_WEIGHTS = float[6](
    0.2491470458, 0.2334925365, 0.2031674267, 0.1600783285, 0.1069393260, 0.0471753364);

// The interval of directions from the foot f to an ellipse: start and length, in radians. f is relative to the centre,
// in units of the semi-axes u, v. If f is inside the ellipse the length is pi: lines are integrated to both sides.
vec2 direction_interval(vec2 u, vec2 v, vec2 f) {
    float square = dot(f, f);
    vec2 perpendicular = vec2(-f.y, f.x), to = square > 1.0 ? -f * sqrt(square - 1.0) : vec2(0.0);
    if (square == 0.0) perpendicular = vec2(1.0, 0.0);
    vec2 first = (to.x + perpendicular.x) * u + (to.y + perpendicular.y) * v;
    vec2 last = (to.x - perpendicular.x) * u + (to.y - perpendicular.y) * v;
    float sine = max(first.x * last.y - first.y * last.x, 0.0);
    return vec2(atan(first.y, first.x), square > 1.0 ? atan2_accurate(sine, dot(first, last)) : 3.141592653589793);
}

// Semi-axes u, v, with u x v > 0. Gauss-Legendre quadrature over directions from the foot; `points` is 12, or 0 as in
// spread_polygon.
float spread_ellipse(vec2 centre, vec2 u, vec2 v, vec3 n, float cone, int points) {
    float area = u.x * v.y - u.y * v.x, sum = 0.0;
    vec2 f = vec2(centre.y * v.x - centre.x * v.y, u.y * centre.x - u.x * centre.y) / area;
    float outside = dot(f, f) - 1.0;
    vec2 interval = direction_interval(u, v, f);
    if (outside <= 0.0) points *= 2;
    for (int k = 0; k < points; ++k) {
        int row = (k >> 1) % 6;
        float t = (k & 1) == 0 ? GAUSS_NODES[row] : -GAUSS_NODES[row], weight = GAUSS_WEIGHTS[row];
        if (outside > 0.0) { // the length of chords grows like a root at both ends of the interval
            weight *= 1.5 - 1.5 * t * t;
            t *= 1.5 - 0.5 * t * t;
        }
        float angle = interval.x + 0.5 * interval.y * (1.0 + t);
        vec2 d = vec2(cos(angle), sin(angle));
        if (k >= 12) d = -d;
        vec2 e = vec2(d.x * v.y - d.y * v.x, u.x * d.y - u.y * d.x) / area;
        float square = dot(e, e), b = dot(e, f), root = sqrt(max(b * b - square * outside, 0.0));
        float far = outside < 0.0 && b > 0.0 ? -outside / (b + root) : (root - b) / square;
        float near = outside > 0.0 ? outside / max(square * far, 1e-30) : 0.0;
        float slope = dot(n.xy, d), horizon = -n.z / slope;
        if (slope < 0.0) far = n.z > 0.0 ? min(far, horizon) : 0.0;
        else if (n.z <= 0.0) near = max(near, slope > 0.0 ? horizon : cone);
        far = min(far, cone);
        vec2 g = radial_integrals(far, cone) - radial_integrals(min(near, far), cone);
        sum += weight * (n.z * g.x + slope * g.y);
    }
    return 0.5 * interval.y * sum;
}
