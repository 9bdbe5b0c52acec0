// What a surface reflects of a light: by a Lambertian lobe of the base color, and by others.
#include "maths/luminance.glsl"
#include "surfaces/camera_ray.glsl"
#include "surfaces/surface.glsl"
#include "lights/light.glsl"
#if GLOSS
#include "surfaces/lobes.glsl"
#endif

const float INVERSE_PI = 0.3183098861837907;

// The Lambertian lobe times the cosine. 1/sr
vec3 evaluate_diffuse(Surface surface, vec3 wi) {
    return surface.base_color * (INVERSE_PI * max(dot(surface.normal, wi), 0.0));
}

// Unshadowed radiance that the Lambertian lobe reflects of a light of this irradiance, for a radiance or intensity of 1.
// W/(sr m^2)
vec3 unshadowed_diffuse(Surface surface, Light light, float irradiance) {
    vec3 emission = light.emission * light_mean_color(light, surface.position, surface.normal);
    return emission * surface.base_color * (INVERSE_PI * irradiance);
}

#if GLOSS
// Microfacets count as if all of the light came from the mirror direction, or else from its middle.
vec3 unshadowed_lobe(Gloss gloss, vec3 n, vec3 wo, vec3 p, Light light, vec3 middle) {
    if (!is_glossy(gloss)) return vec3(0.0);
    float fraction = INVERSE_PI * light_transformed_irradiance(light, p, cosine_from_anchor(gloss, n, wo));
    vec3 mirror = reflect(-wo, n);
    vec3 half_way = normalize(wo + (light_emitted(light, p, mirror) > 0.0 ? mirror : middle));
    return reflectance(gloss, max(dot(wo, half_way), 0.0)) * (gloss.reflected * fraction);
}

// About the unshadowed radiance that the other lobes reflect of a light; exact if that has no size. `irradiance`: as for
// the Lambertian lobe.
vec3 unshadowed_lobes(Surface surface, Lobes lobes, Light light, float irradiance) {
    if (!lobes.exist) return vec3(0.0);
    vec3 n = surface.normal, p = surface.position;
    LightSample from = light_sample(light, p, n, vec2(0.5));
    if (light_is_delta(light, p)) {
        vec3 emission = light.emission * light_color(light, p, from.point);
        return emission * evaluate_lobes(lobes, from.wi).reflected * (from.radiance / from.pdf);
    }
    vec3 sum = unshadowed_lobe(lobes.gloss, n, lobes.wo, p, light, from.wi);
#if COAT
    sum += unshadowed_lobe(lobes.coat, lobes.coat_facets.frame[2], lobes.wo, p, light, from.wi);
#endif
#if RARE_LOBES
    if (lobes.rare.sheen != vec3(0.0)) {
        mat3 transform = sheen_cosine_from_anchor(lobes.rare.sheen_shape, n, lobes.wo);
        sum += lobes.rare.sheen * (INVERSE_PI * light_transformed_irradiance(light, p, transform));
    }
    if (lobes.rare.diffuse_roughness > 0.0) {
        vec3 value = evaluate_rough_diffuse(lobes.base_color, lobes.rare, n, lobes.wo, from.wi);
        sum += value * (irradiance / max(dot(n, from.wi), 0.1));
    }
#endif
    return sum * light.emission * light_mean_color(light, p, n);
}

// The most that corrections can take away of a prediction, as luminance: of rough surfaces also Lambertian reflection.
float correctable_luminance(Lobes lobes, vec3 diffuse, vec3 others) {
    float sum = abs(luminance(others));
#if RARE_LOBES
    if (lobes.rare.diffuse_roughness > 0.0) sum += abs(luminance(diffuse));
#endif
    return sum;
}
#endif
