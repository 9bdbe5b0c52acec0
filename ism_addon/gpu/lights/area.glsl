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
#include "sampling/linear.glsl"
#include "sampling/segment.glsl"
#if ELLIPSES
#include "closed_forms/ellipse.glsl"
#endif
#if SPREADS
#include "closed_forms/spread_irradiance.glsl"
#endif

bool is_rectangle(Light light) { return ELLIPSES == 0 || (RECTANGLES == 1 && light.shape == 0); }

// The irradiance of the light's shape about `centre`, from a receiver of normal n at the origin. `normal`: of its plane.
float area_shape_irradiance(Light light, vec3 centre, vec3 u, vec3 v, vec3 n, vec3 normal) {
#if ELLIPSES
    if (!is_rectangle(light)) return ellipse_irradiance(centre, 0.5 * u, 0.5 * v, n, normal);
#endif
    return polygon_irradiance(centre, u, v, n, normal);
}

// Unshadowed irradiance of a light of radiance 1 without spread.
float area_irradiance_without_spread(Light light, vec3 p, vec3 n) {
    vec3 centre = light.position - p, u = light.axis_u, v = light.axis_v;
    if (dot(light.normal, centre) >= 0.0) return 0.0;
    float scale = inversesqrt(max(dot(centre, centre), max(dot(u, u), dot(v, v)))); // so that no power overflows
    centre *= scale;
    u *= scale;
    v *= scale;
    return area_shape_irradiance(light, centre, u, v, n, light.normal);
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

#include "lights/visible_region.glsl"

// See strip_length.
float chord_strip_length(VisibleRegion region, float x, vec2 chord) {
    float distance = length(vec2(x - region.projection.x, region.height));
    return strip_length(distance, chord.x - region.projection.y, max(chord.y - chord.x, 0.0));
}

// A rectangle's samples are uniform in solid angle times two linear functions, between the following weights: of u, the
// fraction of the angle of x_range, and of v, the fraction of the chord's length. They approximate what uniform ones
// would estimate. A weight of 0 at one end would make samples near it too bright. The falloff of a spread is not linear.
bool has_linear_density(VisibleRegion region) { return region.rectangle && !region.clipped_by_footprint; }

const float MIN_WEIGHT = 0.1; // of the sum of both ends'

// Of v: the cosines to the receiver's normal.
vec2 chord_weights(VisibleRegion region, float x, vec2 chord) {
    vec2 heights = max(region.horizon.x * x + region.horizon.y * chord + region.horizon.z, 0.0);
    vec3 to_first = vec3(vec2(x, chord.x) - region.projection, region.height);
    vec3 to_last = vec3(vec2(x, chord.y) - region.projection, region.height);
    vec2 cosines = heights * inversesqrt(max(vec2(dot(to_first, to_first), dot(to_last, to_last)), 1e-37));
    return cosines + max(MIN_WEIGHT * (cosines.x + cosines.y), 1e-30);
}

// Of u: the irradiance of a strip along the chord.
vec2 strip_weights(VisibleRegion region) {
    vec2 weights;
    for (int k = 0; k < 2; ++k) {
        float x = region.x_range[k];
        vec2 chord = area_chord(region, x), cosines = chord_weights(region, x, chord);
        weights[k] = (cosines.x + cosines.y) * chord_strip_length(region, x, chord);
    }
    return weights + max(MIN_WEIGHT * (weights.x + weights.y), 1e-30);
}

// The density of u on an ellipse: that of the first coordinate of points on a disc.
float disc_density(float u) { return 2.546479089470325 * sqrt(max(u * (1.0 - u), 0.0)); }

LightSample area_sample(Light light, vec3 p, vec3 n, vec2 uv) {
    VisibleRegion region = area_visible_region(light, p, n);
    bool linear = has_linear_density(region);
    float start = region.x_range.x - region.projection.x, width = max(region.x_range.y - region.x_range.x, 0.0);
    float angle = segment_angle(region.height, start, width), density = 1.0;
    if (linear) {
        vec2 weights = strip_weights(region);
        uv.x = sample_linear(weights, uv.x);
        density = linear_pdf(weights, uv.x);
    } else if (!region.rectangle) {
        vec2 disc = sqrt(uv.x) * vec2(cos(6.283185307179586 * uv.y), sin(6.283185307179586 * uv.y));
        uv = 0.5 + 0.5 * vec2(disc.x, disc.y * inversesqrt(max(1.0 - disc.x * disc.x, 1e-14)));
        density = disc_density(uv.x);
    }
    float x = region.x_range.x + along_segment(region.height, start, width, uv.x * angle);
    vec2 chord = area_chord(region, x);
    if (linear) {
        vec2 weights = chord_weights(region, x, chord);
        uv.y = sample_linear(weights, uv.y);
        density *= linear_pdf(weights, uv.y);
    }
    float strip = chord_strip_length(region, x, chord), distance = length(vec2(x - region.projection.x, region.height));
    float y = chord.x;
    y += along_strip(distance, chord.x - region.projection.y, max(chord.y - chord.x, 0.0), uv.y * strip);
    vec3 offset = x * region.x_axis + y * region.y_axis, ray = light.position - p + offset;
    float lateral = length(cross(light.normal, ray));
    return LightSample(light.position + offset, ray * inversesqrt(max(dot(ray, ray), 1e-30)),
                       angle * strip > 0.0 && region.height > 0.0 ? spread_falloff(light, region.height, lateral) : 0.0,
                       max(density, 1e-4) / max(angle * strip, 1e-33), -1);
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
    VisibleRegion region = area_visible_region(light, p, n);
    vec3 hit = area_hit(light, p, wi).z * wi + p - light.position;
    float x = dot(hit, region.x_axis), y = dot(hit, region.y_axis);
    vec2 chord = area_chord(region, x);
    float start = region.x_range.x - region.projection.x, strip = chord_strip_length(region, x, chord);
    float angle = segment_angle(region.height, start, max(region.x_range.y - region.x_range.x, 0.0));
    float u = segment_angle(region.height, start, x - region.x_range.x) / max(angle, 1e-37);
    float v = chord_strip_length(region, x, vec2(chord.x, y)) / max(strip, 1e-37), density = 1.0;
    if (has_linear_density(region))
        density = linear_pdf(strip_weights(region), u) * linear_pdf(chord_weights(region, x, chord), v);
    else if (!region.rectangle)
        density = disc_density(u);
    return density / max(angle * strip, 1e-33);
}

vec3 area_centre(Light light, vec3 p, vec3 to) { return light.position; }

float area_hit_distance(Light light, vec3 p, vec3 wi) { return area_hit(light, p, wi).z; }
