// Spots: points whose intensity is attenuated by the angle to their axis, as in Cycles: smoothly between two cones.
// With a radius, the attenuation is that of each direction, so it varies over the cap that a receiver sees.
#include "../lights/point.glsl"
#include "closed_forms/spherical_lens.glsl"

// A direction from the light in the space in which its cone is circular. Not of unit length.
vec3 spot_local(Light light, vec3 direction) {
    return vec3(dot(direction, light.axis_u), dot(direction, light.axis_v), dot(direction, light.normal));
}

float spot_cosine(vec3 local) { return local.z * inversesqrt(max(dot(local, local), 1e-30)); }

float spot_smoothstep(float x) { return x * x * (3.0 - 2.0 * x); }

float spot_attenuation(Light light, float cosine) {
    return spot_smoothstep(clamp((cosine - light.cone_cosine) * light.cone_scale, 0.0, 1.0));
}

// The attenuation's level sets at a cap: circles around a centre, seen from the receiver. Of a circular cone they are that;
// of an elliptical one, circles of the same gradient in the middle of the cap, whose cosine changes `scale` times as much.
struct SpotLevels { vec3 centre; float cosine; float scale; }; // cosine: in the middle of the cap

SpotLevels spot_levels(Light light, PointCap cap) {
    if (light.circular_cone != 0) return SpotLevels(-light.normal, -dot(cap.axis, light.normal), 1.0);
    vec3 direction = -cap.axis, local = spot_local(light, direction);
    float size = inversesqrt(max(dot(local, local), 1e-30)), c = local.z * size, s = sqrt(max(1.0 - c * c, 0.0));
    vec3 by_local = vec3(0.0, 0.0, size) - c * size * size * local;
    vec3 gradient = by_local.x * light.axis_u + by_local.y * light.axis_v + by_local.z * light.normal;
    gradient -= dot(gradient, direction) * direction;
    float slope = length(gradient);
    if (s < 1e-4 || slope < 1e-6) return SpotLevels(cap.axis, c, 1.0);
    return SpotLevels(c * cap.axis - s / slope * gradient, c, s / slope);
}

// The fraction of a cap's irradiance that is left, at a receiver with this normal: the integral over the level sets, each
// of which has a lens in common with the cap.
float spot_fraction(Light light, PointCap cap, vec3 normal) {
    SpotLevels levels = spot_levels(light, cap);
    vec2 half_cap = vec2(sqrt(max(1.0 - cap.sine * cap.sine, 0.0)), cap.sine);
    float c = levels.cosine, s = sqrt(max(1.0 - c * c, 0.0));
    float lowest = c > -half_cap.x ? c * half_cap.x - s * half_cap.y : -1.0;
    float highest = c < half_cap.x ? c * half_cap.x + s * half_cap.y : 1.0;
    float outer = c + (light.cone_cosine - c) * levels.scale, width = levels.scale / light.cone_scale;
    if (lowest >= outer + width) return 1.0;
    if (highest <= outer) return 0.0;
    float first = max((lowest - outer) / width, 0.0), last = min((highest - outer) / width, 1.0);
    float sum = spot_smoothstep(first), all = 3.141592653589793 * cap.sine * cap.sine * dot(normal, cap.axis);
    // Five points by Gauss and Legendre, denser at both ends, where lenses vanish.
    const float nodes[5] = float[5](0.04691008, 0.23076534, 0.5, 0.76923466, 0.95308992);
    const float weights[5] = float[5](0.11846344, 0.23931434, 0.28444444, 0.23931434, 0.11846344);
    for (int k = 0; k < 5; ++k) {
        float t = nodes[k], x = mix(first, last, spot_smoothstep(t)), level = clamp(outer + width * x, -1.0, 1.0);
        float change = 6.0 * x * (1.0 - x) * (last - first) * 6.0 * t * (1.0 - t) * weights[k];
        vec2 half_level = vec2(level, sqrt(max(1.0 - level * level, 1e-12)));
        sum += change * dot(normal, spherical_lens_irradiance(cap.axis, half_cap, levels.centre, half_level, c)) / all;
    }
    return clamp(sum, 0.0, 1.0);
}

// Of a point's radiance, as it is in a direction from the receiver.
float spot_factor(Light light, vec3 p, vec3 wi) {
    vec3 to = light.position - p;
    if (light.soft_falloff == 0 && dot(to, to) <= light.radius * light.radius) return 1.0; // inside
    return spot_attenuation(light, spot_cosine(spot_local(light, -wi)));
}

LightSample spot_sample(Light light, vec3 p, vec3 n, vec2 uv) {
    LightSample from = point_sample(light, p, n, uv);
    from.radiance *= spot_factor(light, p, from.wi);
    return from;
}

// The mean of the attenuation over a cap's irradiance above the horizon, by the 64 points of a Hammersley set; or the mean
// of its difference from that of the level sets, if these are subtracted.
float spot_mean_of_samples(Light light, PointCap cap, vec3 p, vec3 n, bool subtract_levels) {
    SpotLevels levels = spot_levels(light, cap);
    float outer = levels.cosine + (light.cone_cosine - levels.cosine) * levels.scale, sum = 0.0, all = 0.0;
    for (int k = 0; k < 64; ++k) {
        vec2 uv = vec2((float(k) + 0.5) / 64.0, float(bitfieldReverse(uint(k))) / 4294967296.0);
        LightSample from = point_sample(light, p, n, uv);
        float weight = from.radiance * max(dot(n, from.wi), 0.0) / from.pdf;
        float x = (dot(from.wi, levels.centre) - outer) * light.cone_scale / levels.scale;
        float of_levels = subtract_levels ? spot_smoothstep(clamp(x, 0.0, 1.0)) : 0.0;
        all += weight;
        sum += weight * (spot_attenuation(light, spot_cosine(spot_local(light, -from.wi))) - of_levels);
    }
    return sum / max(all, 1e-30);
}

float spot_irradiance(Light light, vec3 p, vec3 n) {
    float irradiance = point_irradiance(light, p, n);
    if (irradiance == 0.0) return 0.0;
    PointCap cap = point_cap(light, p);
    if (!point_has_radius(light)) {
        return irradiance * spot_attenuation(light, spot_cosine(spot_local(light, -cap.axis)));
    }
    if (cap.sine >= 1.0) return irradiance; // inside
    bool is_cut = dot(n, cap.axis) < cap.sine; // by the horizon
    float fraction = spot_fraction(light, cap, is_cut ? cap.axis : n);
    bool varies = fraction > 0.0 && fraction < 1.0;
    if (varies && is_cut) return irradiance * spot_mean_of_samples(light, cap, p, n, false);
    if (varies && light.circular_cone == 0) fraction += spot_mean_of_samples(light, cap, p, n, true);
    return irradiance * clamp(fraction, 0.0, 1.0);
}

float spot_emitted(Light light, vec3 p, vec3 wi) { return point_emitted(light, p, wi) * spot_factor(light, p, wi); }

float spot_pdf(Light light, vec3 p, vec3 n, vec3 wi) { return point_pdf(light, p, n, wi); }

// Virtual lights lie on a disk around the position, and face along the spot's axis.
float spot_virtual_weight(Light light, vec3 v, vec3 n, vec3 axis) {
    float square = max(dot(v, v), 1e-30), length = sqrt(square);
    float attenuation = spot_attenuation(light, spot_cosine(spot_local(light, v / length)));
    return max(-dot(n, v), 0.0) / (square * length) * attenuation;
}

vec3 spot_centre(Light light, vec3 p, vec3 to) { return light.position; }

float spot_hit_distance(Light light, vec3 p, vec3 wi) { return point_hit_distance(light, p, wi); }
