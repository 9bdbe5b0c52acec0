// Rectangles and ellipses: irradiance in closed form (see closed_forms), and sampling.
// Shader variants for lights of one shape, or without spread, set these to 0: some drivers execute both branches.
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
#if ELLIPSES
#include "closed_forms/ellipse.glsl"
#endif
#if SPREADS
#include "closed_forms/spread_irradiance.glsl"
#endif

bool is_rectangle(Light light) { return ELLIPSES == 0 || (RECTANGLES == 1 && light.shape == 0); }

// Unshadowed irradiance of a light of radiance 1 without spread.
float area_irradiance_without_spread(Light light, vec3 p, vec3 n) {
    vec3 centre = light.position - p, u = light.axis_u, v = light.axis_v;
    if (dot(light.normal, centre) >= 0.0) return 0.0;
    float scale = inversesqrt(max(dot(centre, centre), max(dot(u, u), dot(v, v)))); // so that no power overflows
    centre *= scale;
    u *= scale;
    v *= scale;
#if ELLIPSES
    if (!is_rectangle(light)) return ellipse_irradiance(centre, 0.5 * u, 0.5 * v, n, light.normal);
#endif
    return polygon_irradiance(centre, u, v, n, light.normal);
}

// Factor of the spread on the radiance of a point of the light. The receiver is `height` above the light's plane, and
// its projection on the plane is at the distance `lateral` from the point.
float spread_falloff(Light light, float height, float lateral) {
    if (light.spread_scale == 0.0) return 1.0;
    return max(light.spread_tangent - lateral / max(height, 1e-30), 0.0) * light.spread_scale;
}

#if SPREADS
// Factor of the spread on the irradiance of a small light: the mean over the four points of a quadrature of degree 3,
// weighted by the irradiance without spread. Coordinates lie in the light's plane, in units of the receiver's height.
float small_light_spread_factor(Light light, vec2 centre, vec2 u, vec2 v, vec3 n, int points) {
    float offset = light.shape == 0 ? 0.28867513459 : 0.25, without_spread = 0.0, with_spread = 0.0;
    for (int k = 0; k < points; ++k) {
        vec2 p = centre + offset * ((k & 1) == 0 ? u : -u) + offset * ((k & 2) == 0 ? v : -v);
        float square = 1.0 + dot(p, p), weight = max(n.z + dot(n.xy, p), 1e-9) / (square * square);
        without_spread += weight;
        with_spread += weight * max(light.spread_tangent - length(p), 0.0);
    }
    return light.spread_scale * with_spread / max(without_spread, 1e-30);
}

float area_irradiance_with_spread(Light light, vec3 p, vec3 n, float without_spread) {
    vec3 centre = light.position - p;
    float height = -dot(light.normal, centre);
    float cone = light.spread_tangent; // radius of the spread's cone at the light's plane
    mat2x3 plane = mat2x3(light.tangent, cross(light.tangent, light.normal));
    vec2 to = (centre * plane) / height, u = (light.axis_u * plane) / height, v = (light.axis_v * plane) / height;
    vec3 local_n = vec3(n * plane, -dot(n, light.normal));
    float size = max(dot(u, u), dot(v, v)), distance_to_cone = length(to) - cone;
    if (distance_to_cone > 0.0 && distance_to_cone * distance_to_cone > 0.5 * (dot(u, u) + dot(v, v))) return 0.0;
    bool small = size < 2.5e-3 * min(1.0 + dot(to, to), cone * cone);
    float factor = small_light_spread_factor(light, to, u, v, local_n, small ? 4 : 0), irradiance;
    if (u.x * v.y < u.y * v.x) v = -v;
#if ELLIPSES
    if (!is_rectangle(light)) irradiance = spread_ellipse(to, 0.5 * u, 0.5 * v, local_n, cone, small ? 0 : 12);
    else
#endif
    irradiance = spread_polygon(to, u, v, local_n, cone, small ? 0 : 5);
    return small ? without_spread * factor : max(irradiance, 0.0) * light.spread_scale;
}
#endif

// Unshadowed irradiance of a light of radiance 1. From here on: the functions of GLSL_INTERFACE, see __init__.py, and
// their helpers.
float area_irradiance(Light light, vec3 p, vec3 n) {
    float irradiance = area_irradiance_without_spread(light, p, n);
#if SPREADS
    if (light.spread_scale != 0.0 && irradiance != 0.0) return area_irradiance_with_spread(light, p, n, irradiance);
#endif
    return irradiance;
}

// Weight of a virtual light that faces along `axis`, among those of one light: its irradiance at a receiver of normal n.
// v: from the virtual light to the receiver.
float area_virtual_weight(Light light, vec3 v, vec3 n, vec3 axis) {
    float square = dot(v, v), height = dot(axis, v);
    float weight = max(-dot(n, v), 0.0) * height / max(square * square, 1e-30);
    return weight * spread_falloff(light, height, length(v - height * axis));
}

// The convex region of a light that is visible from a receiver: above the receiver's horizon, and within the spread's
// footprint, a disc on the light's plane about the receiver's projection. Coordinates x, y lie in the light's plane and
// start at its position. Samples are uniform in x over x_range, and in y along the chord at x.
struct VisibleRegion {
    vec3 x_axis, y_axis;
    vec3 horizon;            // points above it have horizon.x x + horizon.y y + horizon.z >= 0
    vec2 footprint_centre;   // the receiver's projection
    float footprint_radius;  // m
    vec2 axis_u, axis_v;     // of the shape: half sides, or semi-axes
    float width;             // the shape's largest x
    float slope;             // the chord at x is slope x +- half_chord; an ellipse's shortens towards both ends
    float half_chord;
    bool rectangle;
    bool clipped_by_horizon;
    bool clipped_by_footprint; // conservative: it may be true without a clip
    vec2 x_range;            // of the region
};

vec2 intersection(vec2 a, vec2 b) { return vec2(max(a.x, b.x), min(a.y, b.y)); } // of two intervals

// The interval of x of the intersection of a disc and the half plane line.x x + line.y y + line.z >= 0.
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

VisibleRegion area_visible_region(Light light, vec3 p, vec3 n) {
    VisibleRegion region;
    vec3 centre = light.position - p, u = 0.5 * light.axis_u, v = 0.5 * light.axis_v;
    float height = -dot(light.normal, centre);
    vec3 to_projection = -(centre + height * light.normal);
    bool has_spread = SPREADS == 1 && light.spread_scale > 0.0;
    region.rectangle = is_rectangle(light);
    region.footprint_radius = height * light.spread_tangent;
    // A rectangle's chords are parallel to v. Those of an ellipse with spread are perpendicular to the line from its
    // centre to the footprint's.
    float distance = length(to_projection);
    bool perpendicular = !region.rectangle && has_spread && distance > 0.0;
    region.y_axis = perpendicular ? cross(light.normal, to_projection / distance) : normalize(v);
    region.x_axis = cross(region.y_axis, light.normal);
    region.axis_u = vec2(dot(u, region.x_axis), dot(u, region.y_axis));
    region.axis_v = vec2(dot(v, region.x_axis), dot(v, region.y_axis));
    region.footprint_centre = vec2(dot(to_projection, region.x_axis), dot(to_projection, region.y_axis));
    vec2 x_of_axes = vec2(region.axis_u.x, region.axis_v.x);
    region.width = region.rectangle ? abs(region.axis_u.x) : length(x_of_axes);
    region.slope = region.rectangle
                       ? region.axis_u.y / region.axis_u.x
                       : dot(x_of_axes, vec2(region.axis_u.y, region.axis_v.y)) / (region.width * region.width);
    region.half_chord = region.rectangle ? length(v) : length(cross(u, v)) / region.width;
    region.horizon = vec3(dot(n, region.x_axis), dot(n, region.y_axis), dot(n, centre));
    float height_amplitude = region.rectangle ? abs(dot(n, u)) + abs(dot(n, v)) : length(vec2(dot(n, u), dot(n, v)));
    region.clipped_by_horizon = height_amplitude > region.horizon.z;
    float size = region.rectangle ? 2.0 * (length(u) + length(v)) : length(u) + length(v);
    region.clipped_by_footprint = has_spread && length(region.footprint_centre) + size > region.footprint_radius;

    region.x_range = vec2(-region.width, region.width);
    if (region.clipped_by_horizon && region.rectangle) {
        float slope = region.horizon.x + region.horizon.y * region.slope;
        region.x_range = intersection(
            region.x_range, half_line(slope, abs(region.horizon.y) * region.half_chord + region.horizon.z));
    } else if (region.clipped_by_horizon) { // the unit disc in x / width, (y - slope x) / half_chord
        vec3 line = vec3((region.horizon.x + region.horizon.y * region.slope) * region.width,
                         region.horizon.y * region.half_chord, region.horizon.z);
        region.x_range = intersection(region.x_range, region.width * disc_extent(vec2(0.0), 1.0, line));
    }
    if (region.clipped_by_footprint) {
        vec2 disc = region.footprint_centre;
        float radius = region.footprint_radius;
        region.x_range = intersection(region.x_range, disc.x + vec2(-radius, radius));
        if (region.rectangle) {
            region.x_range = intersection(
                region.x_range, disc_extent(disc, radius, vec3(region.slope, -1.0, region.half_chord)));
            region.x_range = intersection(
                region.x_range, disc_extent(disc, radius, vec3(-region.slope, 1.0, region.half_chord)));
        }
        if (region.clipped_by_horizon)
            region.x_range = intersection(region.x_range, disc_extent(disc, radius, region.horizon));
    }
    return region;
}

// The ends of the chord at x.
vec2 area_chord(VisibleRegion region, float x) {
    float t = x / region.width;
    float half_chord = region.half_chord * (region.rectangle ? 1.0 : sqrt(max(1.0 - t * t, 0.0)));
    vec2 y = region.slope * x + vec2(-half_chord, half_chord);
    if (region.clipped_by_horizon)
        y = intersection(y, half_line(region.horizon.y, region.horizon.x * x + region.horizon.z));
    if (region.clipped_by_footprint) {
        float dx = x - region.footprint_centre.x, radius = region.footprint_radius;
        float half_footprint = sqrt(max(radius * radius - dx * dx, 0.0));
        y = intersection(y, region.footprint_centre.y + vec2(-half_footprint, half_footprint));
    }
    return y;
}

// An unclipped ellipse is sampled in polar coordinates instead.
bool area_is_unclipped_ellipse(VisibleRegion region) {
    return !region.rectangle && !region.clipped_by_horizon && !region.clipped_by_footprint;
}

// m^2: the inverse of a sample's density by area, given the ends y of the chord at its x.
float area_inverse_density(VisibleRegion region, vec2 y) {
    if (area_is_unclipped_ellipse(region)) return 3.141592653589793 * region.width * region.half_chord;
    return max(region.x_range.y - region.x_range.x, 0.0) * max(y.y - y.x, 0.0);
}

// The density by solid angle, 1/sr. `ray` goes from the receiver, `height` above the light's plane, to the sample.
float area_solid_angle_pdf(vec3 ray, float height, float inverse_density) {
    float square = dot(ray, ray);
    return square * sqrt(square) / max(height * inverse_density, 1e-37);
}

LightSample area_sample(Light light, vec3 p, vec3 n, vec2 uv) {
    VisibleRegion region = area_visible_region(light, p, n);
    vec2 xy = vec2(mix(region.x_range.x, region.x_range.y, uv.x), 0.0), y = area_chord(region, xy.x);
    xy.y = mix(y.x, y.y, uv.y);
    if (area_is_unclipped_ellipse(region)) {
        float radius = sqrt(uv.x), angle = 6.283185307179586 * uv.y;
        xy = radius * (cos(angle) * region.axis_u + sin(angle) * region.axis_v);
    }
    vec3 offset = xy.x * region.x_axis + xy.y * region.y_axis, ray = light.position - p + offset;
    float height = max(-dot(light.normal, ray), 0.0), inverse_density = area_inverse_density(region, y);
    float radiance = height * inverse_density > 0.0
                         ? spread_falloff(light, height, length(cross(light.normal, ray))) : 0.0;
    return LightSample(light.position + offset, ray * inversesqrt(max(dot(ray, ray), 1e-30)), radiance,
                       area_solid_angle_pdf(ray, height, inverse_density));
}

// Where a ray hits the light's plane from its emitting side: coordinates in units of half sides or semi-axes, and the
// distance. Without a hit the coordinates are 2, outside every shape.
vec3 area_hit(Light light, vec3 p, vec3 wi) {
    float cosine = -dot(light.normal, wi), distance = dot(light.normal, p - light.position) / max(cosine, 1e-30);
    vec3 hit = p + distance * wi - light.position;
    vec3 u = cross(light.axis_v, light.normal), v = cross(light.normal, light.axis_u);
    vec2 uv = 2.0 * vec2(dot(hit, u) / dot(light.axis_u, u), dot(hit, v) / dot(light.axis_v, v));
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
    VisibleRegion region = area_visible_region(light, p, n);
    vec2 chord = area_chord(region, dot(ray + p - light.position, region.x_axis));
    return area_solid_angle_pdf(ray, -dot(light.normal, ray), area_inverse_density(region, chord));
}

vec3 area_centre(Light light, vec3 p, vec3 to) { return light.position; }

float area_hit_distance(Light light, vec3 p, vec3 wi) { return area_hit(light, p, wi).z; }
