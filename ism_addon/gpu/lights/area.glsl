// Rectangles and ellipses: their irradiance in closed form, see radiometry.py, and points on them.
// A pass whose lights are none of a shape may say so when it compiles this: some drivers execute both branches.
#ifndef RECTANGLES
#define RECTANGLES 1
#endif
#ifndef ELLIPSES
#define ELLIPSES 1
#endif
#ifndef SPREADS
#define SPREADS 1
#endif
#include "closed_forms/polygon.glsl"
#include "closed_forms/ellipse.glsl"
#include "closed_forms/spread_irradiance.glsl"

bool is_rectangle(Light light) { return ELLIPSES == 0 || (RECTANGLES == 1 && light.shape == 0); }

// Irradiance by a light of radiance 1 that nothing hides, its spread left out.
float full_spread_irradiance(Light light, vec3 p, vec3 n) {
    vec3 centre = light.position - p, u = light.axis_u, v = light.axis_v;
    if (dot(light.normal, centre) >= 0.0) return 0.0;
    float scale = inversesqrt(max(dot(centre, centre), max(dot(u, u), dot(v, v)))); // no power of it overflows
    centre *= scale;
    u *= scale;
    v *= scale;
    if (is_rectangle(light)) return polygon_irradiance(centre, u, v, n, light.normal);
    return ellipse_irradiance(centre, 0.5 * u, 0.5 * v, n, light.normal);
}

// Of the radiance towards a receiver so high over the light's plane, whose foot is so far from where it comes from.
float spread_falloff(Light light, float height, float away) {
    if (light.spread_scale == 0.0) return 1.0;
    return max(light.spread_tangent - away / max(height, 1e-30), 0.0) * light.spread_scale;
}

// Of a light seen as small, in units of the receiver's height: the mean at four points, of the third degree on its
// shape, each weighed by what it would send without a spread.
float small_spread(Light light, vec2 centre, vec2 u, vec2 v, vec3 n, int points) {
    float offset = light.shape == 0 ? 0.28867513459 : 0.25, sent = 0.0, left = 0.0;
    for (int k = 0; k < points; ++k) {
        vec2 at = centre + offset * ((k & 1) == 0 ? u : -u) + offset * ((k & 2) == 0 ? v : -v);
        float square = 1.0 + dot(at, at), weight = max(n.z + dot(n.xy, at), 1e-9) / (square * square);
        sent += weight;
        left += weight * max(light.spread_tangent - length(at), 0.0);
    }
    return light.spread_scale * left / max(sent, 1e-30);
}

// Unshadowed irradiance by a light of radiance 1: the interface of light types.
float area_irradiance(Light light, vec3 p, vec3 n) {
    vec3 centre = light.position - p;
    float full = full_spread_irradiance(light, p, n), height = -dot(light.normal, centre), reach = light.spread_tangent;
    if (SPREADS == 0 || light.spread_scale == 0.0 || full == 0.0) return full;
    mat2x3 plane = mat2x3(light.tangent, cross(light.tangent, light.normal));
    vec2 to = (centre * plane) / height, u = (light.axis_u * plane) / height, v = (light.axis_v * plane) / height;
    vec3 turned = vec3(n * plane, -dot(n, light.normal));
    float size = max(dot(u, u), dot(v, v)), beyond = length(to) - reach;
    if (beyond > 0.0 && beyond * beyond > 0.5 * (dot(u, u) + dot(v, v))) return 0.0;
    bool small = size < 2.5e-3 * min(1.0 + dot(to, to), reach * reach);
    float part = small_spread(light, to, u, v, turned, small ? 4 : 0), sent;
    if (u.x * v.y < u.y * v.x) v = -v;
    if (is_rectangle(light)) sent = spread_polygon(to, u, v, turned, reach, small ? 0 : 5);
    else sent = spread_ellipse(to, 0.5 * u, 0.5 * v, turned, reach, small ? 0 : 12);
    return small ? full * part : max(sent, 0.0) * light.spread_scale;
}

// What a virtual light sends to a receiver at v from it, whose normal is n, in the light's space: a weight among those of
// one light.
float area_virtual_weight(Light light, vec3 v, vec3 n) {
    float square = dot(v, v);
    float weight = max(-dot(n, v), 0.0) * v.z / max(square * square, 1e-30);
    return weight * spread_falloff(light, v.z, length(v.xy));
}

// Points from which a light lights a receiver: within the footprint that the cone of its spread has on its plane, about
// the receiver's foot, and above the receiver's horizon. That part of a light is convex. x is uniform between its ends and
// y along its chord at x, so every point can send light, and the estimate is unbiased.

// What the light would send if all of it were as near, as tilted and as bright as its point at `ray` from the receiver.
float point_irradiance(Light light, vec3 ray, vec3 n) {
    float square = max(dot(ray, ray), 1e-30), height = max(-dot(light.normal, ray), 0.0);
    float area = length(cross(light.axis_u, light.axis_v)) * (light.shape == 0 ? 1.0 : 0.7853981633974483);
    return area * max(dot(n, ray), 0.0) * height * spread_falloff(light, height, length(cross(light.normal, ray))) / (square * square);
}

vec2 overlap(vec2 a, vec2 b) { return vec2(max(a.x, b.x), min(a.y, b.y)); } // of two intervals

// The interval of x of the part of a disc where line.x x + line.y y + line.z >= 0.
vec2 disc_extent(vec2 centre, float radius, vec3 line) {
    float size = max(length(line.xy), 1e-30);
    vec2 n = line.xy / size;
    float d = clamp((dot(n, centre) + line.z / size) / radius, -1.0, 1.0), half_chord = sqrt(1.0 - d * d) * abs(n.y);
    vec2 ends = vec2(d - n.x >= 0.0 ? -1.0 : -d * n.x - half_chord, d + n.x >= 0.0 ? 1.0 : half_chord - d * n.x);
    return d > -1.0 ? centre.x + radius * ends : vec2(1.0, -1.0);
}

// The interval where slope t + height >= 0.
vec2 half_line(float slope, float height) {
    float end = -height / (abs(slope) > 1e-30 ? slope : 1e-30);
    return slope < -1e-30 ? vec2(-1e30, end) : vec2(end, 1e30);
}

// The point that uv, of the unit square, stands for. Coordinates x, y lie in the light's plane, from its position.
LightSample area_sample(Light light, vec3 p, vec3 n, vec2 uv) {
    vec3 centre = light.position - p, u = light.axis_u, v = light.axis_v;
    float height = -dot(light.normal, centre), reach = height * light.spread_tangent;
    vec3 to_foot = -(centre + height * light.normal);
    bool rectangle = is_rectangle(light), has_spread = SPREADS == 1 && light.spread_scale > 0.0;
    if (!rectangle) { u *= 0.5; v *= 0.5; }
    // A rectangle's chords are along v. Those of a round light and its footprint are across the line of both centres.
    float away = length(to_foot);
    vec3 y_axis = !rectangle && has_spread && away > 0.0 ? cross(light.normal, to_foot / away) : normalize(v);
    vec3 x_axis = cross(y_axis, light.normal);
    vec2 along_u = vec2(dot(u, x_axis), dot(u, y_axis)), along_v = vec2(dot(v, x_axis), dot(v, y_axis));
    vec2 foot = vec2(dot(to_foot, x_axis), dot(to_foot, y_axis));
    // The chord of the whole light at x is slope x +- half_chord, a half of which shrinks towards an ellipse's ends.
    float width = rectangle ? abs(along_u.x) : length(vec2(along_u.x, along_v.x));
    float slope = rectangle ? along_u.y / along_u.x : dot(vec2(along_u.x, along_v.x), vec2(along_u.y, along_v.y)) / (width * width);
    float half_chord = rectangle ? 0.5 * length(v) : length(cross(u, v)) / width;
    if (rectangle) width *= 0.5;
    vec3 horizon = vec3(dot(n, x_axis), dot(n, y_axis), dot(n, centre));
    float low = rectangle ? 0.5 * (abs(dot(n, u)) + abs(dot(n, v))) : length(vec2(dot(n, u), dot(n, v)));
    bool cut = low > horizon.z, near = has_spread && length(foot) + length(u) + length(v) > reach;

    vec2 x = vec2(-width, width);
    if (cut && rectangle) {
        x = overlap(x, half_line(horizon.x + horizon.y * slope, abs(horizon.y) * half_chord + horizon.z));
    } else if (cut) { // the ellipse is the unit disc of x / width and (y - slope x) / half_chord
        vec3 line = vec3((horizon.x + horizon.y * slope) * width, horizon.y * half_chord, horizon.z);
        x = overlap(x, width * disc_extent(vec2(0.0), 1.0, line));
    }
    if (near) {
        x = overlap(x, foot.x + vec2(-reach, reach));
        if (rectangle) {
            x = overlap(x, disc_extent(foot, reach, vec3(slope, -1.0, half_chord)));
            x = overlap(x, disc_extent(foot, reach, vec3(-slope, 1.0, half_chord)));
        }
        if (cut) x = overlap(x, disc_extent(foot, reach, horizon));
    }
    vec2 at = vec2(mix(x.x, x.y, uv.x), 0.0);
    float part = at.x / width, whole = half_chord * (rectangle ? 1.0 : sqrt(max(1.0 - part * part, 0.0)));
    vec2 y = slope * at.x + vec2(-whole, whole);
    if (cut) y = overlap(y, half_line(horizon.y, horizon.x * at.x + horizon.z));
    if (near) {
        float off = at.x - foot.x, chord = sqrt(max(reach * reach - off * off, 0.0));
        y = overlap(y, foot.y + vec2(-chord, chord));
    }
    at.y = mix(y.x, y.y, uv.y);
    float area = width * half_chord * (rectangle ? 4.0 : 3.141592653589793);
    float fraction = max(x.y - x.x, 0.0) * max(y.y - y.x, 0.0) / area;
    if (!rectangle && !cut && !near) { // the whole ellipse by equal areas
        float radius = sqrt(uv.x), angle = 6.283185307179586 * uv.y;
        at = radius * (cos(angle) * along_u + sin(angle) * along_v);
        fraction = 1.0;
    }
    vec3 offset = at.x * x_axis + at.y * y_axis;
    return LightSample(light.position + offset, fraction * point_irradiance(light, centre + offset, n));
}
