// What a surface reflects of a light: by a Lambertian lobe of the base color, and by others.
#include "maths/luminance.glsl"
#include "maths/pi.glsl"
#include "surfaces/camera_ray.glsl"
#include "surfaces/surface.glsl"
#include "lights/light.glsl"
#if GLOSS
#include "materials/lobes.glsl"
#endif

// The Lambertian lobe times the cosine. 1/sr
vec3 evaluate_diffuse(Surface surface, vec3 wi) {
    return surface.base_color * (INVERSE_PI * max(dot(surface.normal, wi), 0.0));
}

// Unshadowed radiance that the Lambertian lobe reflects of a light of this irradiance, for a radiance or intensity of 1,
// and mean color. W/(sr m^2)
vec3 unshadowed_diffuse(Surface surface, Light light, float irradiance, vec3 color) {
    vec3 emission = light.emission * color;
    return emission * surface.base_color * (INVERSE_PI * irradiance);
}

#if GLOSS
// What lobes other than Lambert's reflect of a light if nothing is in the way, about; and the BSDF times the cosine that
// it is exact for, if the light's radiance is even.
struct LobePrediction {
    vec3 radiance;   // W/(sr m^2)
    float even;      // the light's radiance, see light_even_radiance
    vec3 reflectance;
    mat3 transform;  // see cosine_from_anchor
#if COAT
    vec3 coat_reflectance;
    mat3 coat_transform;
#endif
#if RARE_LOBES
    mat3 sheen_transform;
#endif
    vec3 further_diffuse; // over the cosine
};

// The density of the direction wi by a transform of a cosine, 1/sr.
float transformed_cosine(mat3 transform, vec3 wi) {
    vec3 to = transform * wi;
    float square = max(dot(to, to), 1e-30);
    return INVERSE_PI * max(to.z, 0.0) * abs(determinant(transform)) / (square * square);
}

// The predicted BSDF times the cosine. 1/sr
vec3 evaluate_prediction(LobePrediction prediction, Lobes lobes, vec3 wi) {
    vec3 sum = prediction.reflectance * transformed_cosine(prediction.transform, wi);
#if COAT
    sum += prediction.coat_reflectance * transformed_cosine(prediction.coat_transform, wi);
#endif
#if RARE_LOBES
    sum += lobes.rare.sheen * transformed_cosine(prediction.sheen_transform, wi);
#endif
    sum += prediction.further_diffuse * max(dot(lobes.normal, wi), 0.0);
    return sum;
}

// Whether `reflected_fraction` is what the lobes reflect of light from everywhere. Up to a roughness of .15, that of coats
// and of anisotropic lobes is, within .3 %.
bool reflected_fraction_is_exact(Lobes lobes) {
    const float MAX_ROUGHNESS = 0.15;
    bool exact = lobes.gloss.edge == vec3(0.0);
#if COAT
    exact = exact && !(is_glossy(lobes.coat) && lobes.coat.roughness > MAX_ROUGHNESS);
#endif
#if RARE_LOBES
    bool differs = lobes.rare.aspect < 1.0 || lobes.rare.beckmann;
    exact = exact && !(differs && lobes.gloss.roughness > MAX_ROUGHNESS);
#endif
    return exact && !lobes.change_diffuse;
}

// Microfacets count as if all of the light came from the mirror direction, or else from its middle.
vec3 mean_reflectance(Gloss gloss, vec3 n, vec3 wo, vec3 p, Light light, vec3 middle, bool everywhere) {
    if (everywhere && gloss.edge == vec3(0.0)) return reflected_fraction(gloss);
    vec3 mirror = reflect(-wo, n);
    vec3 half_way = normalize(wo + (light_emitted(light, p, mirror) > 0.0 ? mirror : middle));
    return gloss.reflected * reflectance(gloss, max(dot(wo, half_way), 0.0));
}

// The irradiance of a light in a transformed space, times its color: `color`, or that of the triangles seen there.
vec3 transformed_irradiance(Light light, vec3 p, mat3 m, vec3 color) {
#if MESH_COLORS
    if (light.triangle_count > 0) return emissive_mesh_transformed_colored_irradiance(light, p, m).yzw;
#endif
#if HAS_ENVIRONMENT
    if (light.shape == ENVIRONMENT) return environment_transformed_color(m);
#endif
    return light_transformed_irradiance(light, p, m) * color;
}

// Exact if the light has no size. `irradiance` and `color`: as for the Lambertian lobe.
LobePrediction predict_lobes(Surface surface, Lobes lobes, Light light, float irradiance, vec3 color) {
    LobePrediction prediction;
    prediction.radiance = vec3(0.0);
    prediction.even = 0.0;
    if (!lobes.exist) return prediction;
    vec3 n = surface.normal, p = surface.position;
    LightSample from = light_sample(light, p, n, vec2(0.5));
    if (light_is_delta(light, p)) {
        vec3 emission = light.emission * light_color(light, p, from.point, from.triangle);
        lobes.gloss = gloss_for_points(lobes.gloss);
#if COAT
        lobes.coat = gloss_for_points(lobes.coat);
#endif
        prediction.radiance = emission * evaluate_lobes(lobes, from.wi).reflected * (from.radiance / from.pdf);
        return prediction;
    }
    vec3 sum = vec3(0.0);
    prediction.even = light_even_radiance(light, p, n);
    bool everywhere = prediction.even == EVERYWHERE;
    if (everywhere && !reflected_fraction_is_exact(lobes)) prediction.even = 0.0;
    prediction.transform = cosine_from_anchor(lobes.gloss, n, lobes.wo);
#if RARE_LOBES
    if (lobes.rare.aspect < 1.0)
        prediction.transform *= isotropic_from_anisotropic(lobes.gloss, lobes.facets, lobes.rare.aspect, lobes.wo);
#endif
    prediction.reflectance = vec3(0.0);
    if (is_glossy(lobes.gloss)) {
        prediction.reflectance = mean_reflectance(lobes.gloss, n, lobes.wo, p, light, from.wi, everywhere);
        sum += prediction.reflectance * (INVERSE_PI * transformed_irradiance(light, p, prediction.transform, color));
    }
#if COAT
    vec3 coat_normal = lobes.coat_facets.frame[2];
    prediction.coat_transform = cosine_from_anchor(lobes.coat, coat_normal, lobes.wo);
    prediction.coat_reflectance = vec3(0.0);
    if (is_glossy(lobes.coat)) {
        prediction.coat_reflectance = mean_reflectance(lobes.coat, coat_normal, lobes.wo, p, light, from.wi, everywhere);
        vec3 fraction = INVERSE_PI * transformed_irradiance(light, p, prediction.coat_transform, color);
        sum += prediction.coat_reflectance * fraction;
    }
#endif
#if RARE_LOBES
    prediction.sheen_transform = sheen_cosine_from_anchor(lobes.rare.sheen_shape, n, lobes.wo);
    if (lobes.rare.sheen != vec3(0.0)) {
        vec3 fraction = INVERSE_PI * transformed_irradiance(light, p, prediction.sheen_transform, color);
        sum += lobes.rare.sheen * fraction;
    }
#endif
    prediction.further_diffuse = vec3(0.0);
    if (lobes.change_diffuse) {
        vec3 value = evaluate_further_diffuse(lobes, from.wi);
        prediction.further_diffuse = value / max(dot(n, from.wi), 0.1);
        sum += prediction.further_diffuse * irradiance * color;
    }
    prediction.radiance = sum * light.emission;
    return prediction;
}

// The most that corrections can take away of a prediction, as luminance.
float correctable_luminance(Lobes lobes, vec3 diffuse, vec3 others) {
    return abs(luminance(others)) + (lobes.change_diffuse ? abs(luminance(diffuse)) : 0.0);
}
#endif
