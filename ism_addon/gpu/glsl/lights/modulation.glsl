// What a light's nodes multiply its radiance by, as in Cycles: Light Falloff by the distance, IES Texture by the direction.
// Included after the functions of plain lights.
#ifndef FALLOFF
#define FALLOFF 1
#endif
#ifndef PROFILE
#define PROFILE 16 // points of a light whose mean is the factor of its irradiance; 0: no light has a profile
#endif
uniform uvec2 mean_point_shift; // of the points of means, in 32-bit fixed point

// The point k of a Hammersley set of `count`, shifted.
vec2 mean_point(int k, int count) {
    uvec2 at = uvec2(uint(k) * (4294967295u / uint(count)), bitfieldReverse(uint(k))) + mean_point_shift;
    return vec2(at >> 8u) / 16777216.0;
}

float light_falloff(Light light, float distance) {
#if FALLOFF
    float square = distance * distance;
    float factor = light.falloff_power == 0 ? 1.0 : light.falloff_power == 1 ? distance : square;
    return light.falloff_smooth > 0.0 ? factor * square / (square + light.falloff_smooth) : factor;
#else
    return 1.0;
#endif
}

// About the mean distance of a light's points. Those of a sphere are nearer than its centre by two thirds of its radius.
float light_mean_distance(Light light, vec3 p) {
    float distance = length(light.position - p);
    return light.soft_falloff != 0 ? distance : max(distance - 2.0 / 3.0 * light.radius, light.radius / 3.0);
}

#if PROFILE
// The factor at one of a profile's azimuths; see profile_words in modulation.py.
float profile_at_azimuth(int first, int azimuth, float polar) {
    int index = min(int(polar), 3 * PROFILE_TEXELS - 1);
    vec4 four = uintBitsToFloat(texelFetch(scene_records, light_texels + first + azimuth * PROFILE_TEXELS + index / 3));
    return mix(four[index % 3], four[index % 3 + 1], polar - float(index));
}
#endif

// In a direction from the light, of any length.
float light_profile(Light light, vec3 direction) {
#if PROFILE
    if (light.profile < 0) return 1.0;
    vec2 xy = vec2(dot(direction, light.profile_x), dot(direction, light.profile_y));
    float across = dot(xy, xy), polar = atan(sqrt(max(across, 1e-30)), dot(direction, light.profile_down)) * (float(3 * PROFILE_TEXELS) / 3.141592653589793);
    float turn = across > 0.0 ? atan(-xy.x, -xy.y) / 6.283185307179586 : 0.0;
    float azimuth = (turn < 0.0 ? turn + 1.0 : turn) * float(PROFILE_AZIMUTHS - 1);
    int row = min(int(azimuth), PROFILE_AZIMUTHS - 2);
    float before = profile_at_azimuth(light.profile, row, polar);
    return mix(before, profile_at_azimuth(light.profile, row + 1, polar), azimuth - float(row));
#else
    return 1.0;
#endif
}

// The factor in light_irradiance, over that of light from one point. Of lights without a profile.
float light_falloff_ratio(Light light, vec3 p, vec3 point) {
#if FALLOFF
    return light_falloff(light, light_mean_distance(light, p)) / max(light_falloff(light, length(point - p)), 1e-30);
#else
    return 1.0;
#endif
}

// The mean of a profile over a light's irradiance.
float light_mean_profile(Light light, vec3 p, vec3 n) {
#if PROFILE > 1
    if (light.profile < 0) return 1.0;
    float sum = 0.0, all = 0.0;
    for (int k = 0; k < PROFILE; ++k) {
        LightSample from = plain_light_sample(light, p, n, mean_point(k, PROFILE));
        float weight = from.radiance * max(dot(n, from.wi), 0.0) / from.pdf;
        all += weight;
        sum += weight * light_profile(light, -from.wi);
    }
    return sum / max(all, 1e-30);
#else
    return light_profile(light, p - light.position);
#endif
}

float light_irradiance(Light light, vec3 p, vec3 n) {
    float irradiance = plain_light_irradiance(light, p, n) * light_falloff(light, light_mean_distance(light, p));
    return irradiance == 0.0 ? 0.0 : irradiance * light_mean_profile(light, p, n);
}

LightSample light_sample(Light light, vec3 p, vec3 n, vec2 uv) {
    LightSample from = plain_light_sample(light, p, n, uv);
    from.radiance *= light_falloff(light, length(from.point - p)) * light_profile(light, -from.wi);
    return from;
}

float light_emitted(Light light, vec3 p, vec3 wi) {
    float radiance = plain_light_emitted(light, p, wi);
    if (radiance <= 0.0) return 0.0;
    return radiance * light_falloff(light, light_hit_distance(light, p, wi)) * light_profile(light, -wi);
}

float light_virtual_weight(Light light, vec3 v, vec3 n, vec3 axis) {
    return plain_light_virtual_weight(light, v, n, axis) * light_falloff(light, length(v)) * light_profile(light, v);
}

#if REFLECTED
float light_even_radiance(Light light, vec3 p, vec3 n) {
#if PROFILE
    if (light.profile >= 0) return 0.0;
#endif
    return plain_light_even_radiance(light, p, n) * light_falloff(light, light_mean_distance(light, p));
}

float light_transformed_irradiance(Light light, vec3 p, mat3 m) {
    float irradiance = plain_light_transformed_irradiance(light, p, m) * light_falloff(light, light_mean_distance(light, p));
    return irradiance == 0.0 ? 0.0 : irradiance * light_profile(light, p - light.position);
}
#endif
