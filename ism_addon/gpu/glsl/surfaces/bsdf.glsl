// BSDF of surfaces: Lambertian, with the base color as reflectance.
#include "surfaces/surface.glsl"
#include "lights/light.glsl"

const float INVERSE_PI = 0.3183098861837907;

bool reflects(Surface surface) { return surface.material.base_color != vec3(0.0); }

// The BSDF times the cosine. 1/sr
vec3 bsdf_evaluate(Surface surface, vec3 wi) {
    return surface.material.base_color * (INVERSE_PI * max(dot(surface.normal, wi), 0.0));
}

// Unshadowed radiance by a light of this irradiance, for a radiance or intensity of 1. W/(sr m^2)
vec3 bsdf_unshadowed(Surface surface, Light light, float irradiance) {
    vec3 emission = light.emission * light_mean_color(light, surface.position, surface.normal);
    return emission * surface.material.base_color * (INVERSE_PI * irradiance);
}

// An unbiased estimate of bsdf_unshadowed, if the light's irradiance is exact.
vec3 bsdf_estimate(Surface surface, Light light, LightSample from) {
    vec3 emission = light.emission * light_color(light, surface.position, from.point);
    return emission * bsdf_evaluate(surface, from.wi) * (from.radiance / from.pdf);
}
