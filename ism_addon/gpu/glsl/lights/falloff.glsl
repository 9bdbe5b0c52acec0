// What a Light Falloff node multiplies radiance by, as in Cycles. Included after the functions of plain lights.
#ifndef FALLOFF
#define FALLOFF 1
#endif

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

// The factor in light_irradiance, over that of light from one point.
float light_falloff_ratio(Light light, vec3 p, vec3 point) {
#if FALLOFF
    return light_falloff(light, light_mean_distance(light, p)) / max(light_falloff(light, length(point - p)), 1e-30);
#else
    return 1.0;
#endif
}

float light_irradiance(Light light, vec3 p, vec3 n) {
    return plain_light_irradiance(light, p, n) * light_falloff(light, light_mean_distance(light, p));
}

LightSample light_sample(Light light, vec3 p, vec3 n, vec2 uv) {
    LightSample from = plain_light_sample(light, p, n, uv);
    from.radiance *= light_falloff(light, length(from.point - p));
    return from;
}

float light_emitted(Light light, vec3 p, vec3 wi) {
    float radiance = plain_light_emitted(light, p, wi);
    return radiance > 0.0 ? radiance * light_falloff(light, light_hit_distance(light, p, wi)) : 0.0;
}

float light_virtual_weight(Light light, vec3 v, vec3 n, vec3 axis) {
    return plain_light_virtual_weight(light, v, n, axis) * light_falloff(light, length(v));
}
