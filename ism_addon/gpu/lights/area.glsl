// Rectangles and ellipses: their irradiance in closed form (see closed_forms), and samples on them.
// A shader variant for lights of one shape, or without spread, sets these to 0, as some drivers execute both branches.
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

// Unshadowed irradiance of a light of radiance 1 without spread.
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

// The factor of the spread on the radiance of a point, towards a receiver `height` above the light's plane whose
// projection on it is `lateral` from the point.
float spread_falloff(Light light, float height, float lateral) {
    if (light.spread_scale == 0.0) return 1.0;
    return max(light.spread_tangent - lateral / max(height, 1e-30), 0.0) * light.spread_scale;
}

// The factor of the spread on the irradiance of a small light. Coordinates lie in its plane, in units of the receiver's
// height. The mean over four points of a quadrature exact to the third degree, weighted by irradiance without spread.
float small_spread(Light light, vec2 centre, vec2 u, vec2 v, vec3 n, int points) {
    float offset = light.shape == 0 ? 0.28867513459 : 0.25, without_spread = 0.0, with_spread = 0.0;
    for (int k = 0; k < points; ++k) {
        vec2 at = centre + offset * ((k & 1) == 0 ? u : -u) + offset * ((k & 2) == 0 ? v : -v);
        float square = 1.0 + dot(at, at), weight = max(n.z + dot(n.xy, at), 1e-9) / (square * square);
        without_spread += weight;
        with_spread += weight * max(light.spread_tangent - length(at), 0.0);
    }
    return light.spread_scale * with_spread / max(without_spread, 1e-30);
}

// Unshadowed irradiance of a light of radiance 1. From here on: the interface of light types, see __init__.py.
float area_irradiance(Light light, vec3 p, vec3 n) {
    vec3 centre = light.position - p;
    float full = full_spread_irradiance(light, p, n), height = -dot(light.normal, centre);
    float cone = light.spread_tangent; // radius of the spread's cone at the light's plane
    if (SPREADS == 0 || light.spread_scale == 0.0 || full == 0.0) return full;
    mat2x3 plane = mat2x3(light.tangent, cross(light.tangent, light.normal));
    vec2 to = (centre * plane) / height, u = (light.axis_u * plane) / height, v = (light.axis_v * plane) / height;
    vec3 local_n = vec3(n * plane, -dot(n, light.normal));
    float size = max(dot(u, u), dot(v, v)), beyond = length(to) - cone;
    if (beyond > 0.0 && beyond * beyond > 0.5 * (dot(u, u) + dot(v, v))) return 0.0;
    bool small = size < 2.5e-3 * min(1.0 + dot(to, to), cone * cone);
    float factor = small_spread(light, to, u, v, local_n, small ? 4 : 0), irradiance;
    if (u.x * v.y < u.y * v.x) v = -v;
    if (is_rectangle(light)) irradiance = spread_polygon(to, u, v, local_n, cone, small ? 0 : 5);
    else irradiance = spread_ellipse(to, 0.5 * u, 0.5 * v, local_n, cone, small ? 0 : 12);
    return small ? full * factor : max(irradiance, 0.0) * light.spread_scale;
}

// Irradiance of a virtual light at a receiver whose normal is n, v from it, in the light's space: its weight among the
// virtual lights of one light.
float area_virtual_weight(Light light, vec3 v, vec3 n) {
    float square = dot(v, v);
    float weight = max(-dot(n, v), 0.0) * v.z / max(square * square, 1e-30);
    return weight * spread_falloff(light, v.z, length(v.xy));
}

// The part of a light that lights a receiver: above the receiver's horizon, and within the spread's footprint, a disc
// on the light's plane about the receiver's projection. It is convex. Coordinates x, y lie in the light's plane, from
// its position. Samples are uniform in x over the part's interval, and in y along the chord at x.
struct AreaPart {
    vec3 x_axis, y_axis;
    vec3 horizon;            // the part has horizon.x x + horizon.y y + horizon.z >= 0
    vec2 footprint_centre;   // the receiver's projection
    float footprint_radius;  // m
    vec2 axis_u, axis_v;     // of the shape: half sides, or semi-axes
    float width;             // the shape's largest x
    float slope;             // the shape's chord at x is slope x +- half_chord, of an ellipse less towards its ends
    float half_chord;
    bool rectangle;
    bool cut_by_horizon;
    bool cut_by_footprint;   // it may be
    vec2 x;                  // the part's interval
};

vec2 intersection(vec2 a, vec2 b) { return vec2(max(a.x, b.x), min(a.y, b.y)); } // of two intervals

// The interval of x of what a half plane, line.x x + line.y y + line.z >= 0, leaves of a disc.
vec2 disc_extent(vec2 centre, float radius, vec3 line) {
    float size = max(length(line.xy), 1e-30);
    vec2 n = line.xy / size;
    float d = clamp((dot(n, centre) + line.z / size) / radius, -1.0, 1.0), half_chord = sqrt(1.0 - d * d) * abs(n.y);
    vec2 ends = vec2(d - n.x >= 0.0 ? -1.0 : -d * n.x - half_chord, d + n.x >= 0.0 ? 1.0 : half_chord - d * n.x);
    return d > -1.0 ? centre.x + radius * ends : vec2(1.0, -1.0);
}

// The interval of t where slope t + height >= 0.
vec2 half_line(float slope, float height) {
    float end = -height / (abs(slope) > 1e-30 ? slope : 1e-30);
    return slope < -1e-30 ? vec2(-1e30, end) : vec2(end, 1e30);
}

AreaPart area_part(Light light, vec3 p, vec3 n) {
    AreaPart part;
    vec3 centre = light.position - p, u = 0.5 * light.axis_u, v = 0.5 * light.axis_v;
    float height = -dot(light.normal, centre);
    vec3 to_projection = -(centre + height * light.normal);
    bool has_spread = SPREADS == 1 && light.spread_scale > 0.0;
    part.rectangle = is_rectangle(light);
    part.footprint_radius = height * light.spread_tangent;
    // A rectangle's chords are along v. Those of a round light and its footprint are across the line of both centres.
    float distance = length(to_projection);
    bool across = !part.rectangle && has_spread && distance > 0.0;
    part.y_axis = across ? cross(light.normal, to_projection / distance) : normalize(v);
    part.x_axis = cross(part.y_axis, light.normal);
    part.axis_u = vec2(dot(u, part.x_axis), dot(u, part.y_axis));
    part.axis_v = vec2(dot(v, part.x_axis), dot(v, part.y_axis));
    part.footprint_centre = vec2(dot(to_projection, part.x_axis), dot(to_projection, part.y_axis));
    vec2 x_of_axes = vec2(part.axis_u.x, part.axis_v.x);
    part.width = part.rectangle ? abs(part.axis_u.x) : length(x_of_axes);
    part.slope = part.rectangle ? part.axis_u.y / part.axis_u.x
                                : dot(x_of_axes, vec2(part.axis_u.y, part.axis_v.y)) / (part.width * part.width);
    part.half_chord = part.rectangle ? length(v) : length(cross(u, v)) / part.width;
    part.horizon = vec3(dot(n, part.x_axis), dot(n, part.y_axis), dot(n, centre));
    float low = part.rectangle ? abs(dot(n, u)) + abs(dot(n, v)) : length(vec2(dot(n, u), dot(n, v)));
    part.cut_by_horizon = low > part.horizon.z;
    float size = part.rectangle ? 2.0 * (length(u) + length(v)) : length(u) + length(v);
    part.cut_by_footprint = has_spread && length(part.footprint_centre) + size > part.footprint_radius;

    part.x = vec2(-part.width, part.width);
    if (part.cut_by_horizon && part.rectangle) {
        float slope = part.horizon.x + part.horizon.y * part.slope;
        part.x = intersection(part.x, half_line(slope, abs(part.horizon.y) * part.half_chord + part.horizon.z));
    } else if (part.cut_by_horizon) { // the ellipse is the unit disc of x / width and (y - slope x) / half_chord
        vec3 line = vec3((part.horizon.x + part.horizon.y * part.slope) * part.width, part.horizon.y * part.half_chord,
                         part.horizon.z);
        part.x = intersection(part.x, part.width * disc_extent(vec2(0.0), 1.0, line));
    }
    if (part.cut_by_footprint) {
        vec2 disc = part.footprint_centre;
        float radius = part.footprint_radius;
        part.x = intersection(part.x, disc.x + vec2(-radius, radius));
        if (part.rectangle) {
            part.x = intersection(part.x, disc_extent(disc, radius, vec3(part.slope, -1.0, part.half_chord)));
            part.x = intersection(part.x, disc_extent(disc, radius, vec3(-part.slope, 1.0, part.half_chord)));
        }
        if (part.cut_by_horizon) part.x = intersection(part.x, disc_extent(disc, radius, part.horizon));
    }
    return part;
}

// The ends of the chord at x.
vec2 area_chord(AreaPart part, float x) {
    float t = x / part.width;
    float half_chord = part.half_chord * (part.rectangle ? 1.0 : sqrt(max(1.0 - t * t, 0.0)));
    vec2 y = part.slope * x + vec2(-half_chord, half_chord);
    if (part.cut_by_horizon) y = intersection(y, half_line(part.horizon.y, part.horizon.x * x + part.horizon.z));
    if (part.cut_by_footprint) {
        float off = x - part.footprint_centre.x, radius = part.footprint_radius;
        float half_footprint = sqrt(max(radius * radius - off * off, 0.0));
        y = intersection(y, part.footprint_centre.y + vec2(-half_footprint, half_footprint));
    }
    return y;
}

// An ellipse that nothing cuts is sampled in polar coordinates instead.
bool area_is_whole_ellipse(AreaPart part) { return !part.rectangle && !part.cut_by_horizon && !part.cut_by_footprint; }

// m^2, the inverse of a sample's density by area, given the chord at its x.
float area_inverse_density(AreaPart part, vec2 y) {
    if (area_is_whole_ellipse(part)) return 3.141592653589793 * part.width * part.half_chord;
    return max(part.x.y - part.x.x, 0.0) * max(y.y - y.x, 0.0);
}

// The density by solid angle, 1/sr. `ray` goes from the receiver, `height` above the light's plane, to the sample.
float area_solid_angle_pdf(vec3 ray, float height, float inverse_density) {
    float square = dot(ray, ray);
    return square * sqrt(square) / max(height * inverse_density, 1e-37);
}

LightSample area_sample(Light light, vec3 p, vec3 n, vec2 uv) {
    AreaPart part = area_part(light, p, n);
    vec2 at = vec2(mix(part.x.x, part.x.y, uv.x), 0.0), y = area_chord(part, at.x);
    at.y = mix(y.x, y.y, uv.y);
    if (area_is_whole_ellipse(part)) {
        float radius = sqrt(uv.x), angle = 6.283185307179586 * uv.y;
        at = radius * (cos(angle) * part.axis_u + sin(angle) * part.axis_v);
    }
    vec3 offset = at.x * part.x_axis + at.y * part.y_axis, ray = light.position - p + offset;
    float height = max(-dot(light.normal, ray), 0.0), inverse_density = area_inverse_density(part, y);
    float radiance = height * inverse_density > 0.0
                         ? spread_falloff(light, height, length(cross(light.normal, ray))) : 0.0;
    return LightSample(light.position + offset, ray * inversesqrt(max(dot(ray, ray), 1e-30)), radiance,
                       area_solid_angle_pdf(ray, height, inverse_density));
}

// Where a ray meets the light's plane from its emitting side: coordinates in half sides or semi-axes, and the distance.
// Without an intersection, coordinates of 2, outside every shape.
vec3 area_hit(Light light, vec3 p, vec3 wi) {
    float cosine = -dot(light.normal, wi), distance = dot(light.normal, p - light.position) / max(cosine, 1e-30);
    vec3 at = p + distance * wi - light.position;
    vec3 u = cross(light.axis_v, light.normal), v = cross(light.normal, light.axis_u);
    vec2 uv = 2.0 * vec2(dot(at, u) / dot(light.axis_u, u), dot(at, v) / dot(light.axis_v, v));
    return cosine > 0.0 && distance > 0.0 ? vec3(uv, distance) : vec3(2.0);
}

float area_emitted(Light light, vec3 p, vec3 wi) {
    vec3 hit = area_hit(light, p, wi);
    float norm = is_rectangle(light) ? max(abs(hit.x), abs(hit.y)) : length(hit.xy);
    if (norm > 1.0) return 0.0;
    vec3 ray = hit.z * wi;
    return spread_falloff(light, -dot(light.normal, ray), length(cross(light.normal, ray)));
}

float area_pdf(Light light, vec3 p, vec3 n, vec3 wi) {
    if (dot(n, wi) <= 0.0 || area_emitted(light, p, wi) <= 0.0) return 0.0;
    vec3 ray = area_hit(light, p, wi).z * wi;
    AreaPart part = area_part(light, p, n);
    vec2 chord = area_chord(part, dot(ray + p - light.position, part.x_axis));
    return area_solid_angle_pdf(ray, -dot(light.normal, ray), area_inverse_density(part, chord));
}
