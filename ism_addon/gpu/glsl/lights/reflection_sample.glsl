// A sample of the light that a surface reflects, and what its lobes reflect of it.
#include "maths/luminance.glsl"
#include "surfaces/bsdf.glsl"
#include "lights/portal_rays.glsl"
#include "lights/resampled_light_sample.glsl"

struct ReflectionSample {
    LightSample from;
    vec3 diffuse; // estimates of the radiance that each lobe reflects
#if GLOSS
    vec3 gloss;
    vec3 correction; // of the prediction of the other lobes: by both candidates, which takes no ray
#endif
};

#if GLOSS
// The sample is one of two candidates, so that one shadow ray serves both lobes (Talbot, Cline & Egbert 2005): a point of
// the light, and the direction that a visible microfacet reflects. Their weights are those of the balance heuristic (Veach
// & Guibas 1995). There the density of the second is multiplied by the fraction of the reflected light that microfacets
// reflect: otherwise the faint gloss of a wall would direct as many rays as its diffuse reflection.
uniform uvec3 lobe_pixel_steps; // of the sequence of a microfacet's normal, and of the choice between the candidates
uniform uvec3 lobe_ray_steps;
uniform uvec3 lobe_light_steps;

vec3 lobe_sequence(ivec2 at, uvec3 shift, uint index) {
    uvec3 fixed_point = shift + pixel_index(at) * lobe_pixel_steps + index * lobe_ray_steps;
    return vec3(fixed_point >> 8u) / 16777216.0;
}

// The fraction of the reflected light that microfacets reflect. Not 0, as it weights densities.
float share_of_microfacets(Surface surface, Lobes lobes) {
    float gloss = luminance(reflected_fraction(lobes));
    return clamp(gloss / max(gloss + luminance(surface.base_color), 1e-37), 1e-3, 1.0);
}

// Where a light emits from in a direction. Suns and the world do from where a ray has left the scene, as their samples: a
// ray to their true distance would overflow. A ray to a mesh must not hit it: it ends before it by the rounding errors.
vec3 emitting_point(Light light, vec3 p, vec3 wi) {
    float distance = light_hit_distance(light, p, wi), error = 1e-5 * (dot(abs(p), vec3(1.0)) + distance);
    return p + (distance < 1e28 ? distance - min(error, 0.5 * distance) : 2.0 * scene_extent.x) * wi;
}

// Where the light's radiance is even and has one `color`, candidates differ from the prediction by as much as the BSDF does; otherwise their
// sum does. That of light from everywhere is exact.
ReflectionSample reflection_sample(Surface surface, Lobes lobes, LobePrediction prediction, Light light, vec2 light_uv,
                                   vec3 lobe_uv, float irradiance, vec3 color) {
    vec3 p = surface.position, n = surface.normal;
    vec3 even = prediction.even * light.emission * color;
    LightSample by_light = resampled_light_sample(light, p, n, light_uv, irradiance);
    LobeValue value = LobeValue(vec3(0.0), 0.0);
    if (lobes.exist) value = evaluate_lobes(lobes, by_light.wi);
#if LOBE_CANDIDATES
    bool has_other = lobes.gloss_share >= 0.0;
#else
    const bool has_other = false; // the light's density in any direction takes too long
#endif
    float share = share_of_microfacets(surface, lobes), density = by_light.pdf + (has_other ? share * value.pdf : 0.0);
    vec3 light_sum = light.emission * light_color(light, p, by_light.point, by_light.triangle) * (by_light.radiance / density);
    vec3 diffuse = light_sum * evaluate_diffuse(surface, by_light.wi), reflected = light_sum * value.reflected;
    ReflectionSample kept = ReflectionSample(by_light, diffuse, reflected, reflected);
    if (prediction.even == EVERYWHERE) kept.correction = vec3(0.0);
    else if (prediction.even == 0.0) kept.correction -= prediction.radiance;
    else if (by_light.radiance > 0.0) kept.correction -= even / density * evaluate_prediction(prediction, lobes, by_light.wi);
#if LOBE_CANDIDATES
    if (!has_other) return kept;
    vec3 wi = sample_lobes(lobes, lobe_uv.xy);
    float radiance = dot(n, wi) > 0.0 ? light_emitted(light, p, wi) : 0.0;
    if (radiance <= 0.0) return kept;
    value = evaluate_lobes(lobes, wi);
    float other_pdf = light_pdf(light, p, n, wi);
    density = max(value.pdf + other_pdf / share, 1e-37);
    vec3 point = emitting_point(light, p, wi);
    int triangle = light_triangle(light, p, wi);
    light_sum = light.emission * light_color(light, p, point, triangle) * (radiance / density);
    vec3 other_diffuse = light_sum * evaluate_diffuse(surface, wi), other_gloss = light_sum * value.reflected;
    if (prediction.even != EVERYWHERE) kept.correction += other_gloss;
    if (prediction.even > 0.0) kept.correction -= even / density * evaluate_prediction(prediction, lobes, wi);
    float first = abs(luminance(diffuse + reflected)) * ray_importance(light, n, by_light.wi, by_light.pdf);
    float second = abs(luminance(other_diffuse + other_gloss)) * ray_importance(light, n, wi, other_pdf);
    float probability = second > 0.0 ? first / (first + second) : 1.0;
    if (lobe_uv.z >= probability) {
        kept.from = LightSample(point, wi, radiance, density, triangle);
        kept.diffuse = other_diffuse;
        kept.gloss = other_gloss;
        probability = 1.0 - probability;
    }
    kept.diffuse /= probability;
    kept.gloss /= probability;
#endif
    return kept;
}
#else
ReflectionSample reflection_sample(Surface surface, Light light, vec2 light_uv, float irradiance) {
    LightSample from = resampled_light_sample(light, surface.position, surface.normal, light_uv, irradiance);
    vec3 emission = light.emission * light_color(light, surface.position, from.point, from.triangle);
    return ReflectionSample(from, emission * evaluate_diffuse(surface, from.wi) * (from.radiance / from.pdf));
}
#endif
