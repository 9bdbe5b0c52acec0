// Points on a light from which it lights a receiver: within the footprint that the cone of its spread has on its plane,
// about the receiver's foot, and above the receiver's horizon. That part of a light is convex. x is uniform between its
// ends and y along its chord at x, so every point can send light, and the estimate is unbiased.
#include "lights/spread.glsl"

struct LightSample { vec3 point; float irradiance; }; // m; an unbiased estimate of light_irradiance

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
LightSample light_sample(Light light, vec3 p, vec3 n, vec2 uv) {
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
