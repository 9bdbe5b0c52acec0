// One light at each pixel: its predicted radiance towards the camera, and in some samples a ray that corrects it. To a
// hard light, a ray replaces an uncertain prediction in each sample, the first one included. CORRECT: samples of glossy
// lobes correct what is predicted of these, with or without a ray.
#include "surfaces/receiver_linking.glsl"
#include "trace/ray_scheduling.glsl"
#include "lights/reflection_sample.glsl"
#include "trace/ray_correction.glsl"
#include "surfaces/predicted_pixel.glsl"
#if CACHED
#include "textures/irradiance_cache.glsl"
#endif
uniform sampler2D prediction;         // visibility, whether it is uncertain
uniform sampler2D predicted_pixels;   // see match_predictions.frag
uniform uvec3 light_uv_shift;         // of points on the light, of samples that trace rays
#if GLOSS
uniform uvec3 lobe_shift;             // of the sequence of candidates
#endif
flat in int tile_light;
flat in float tile_visibility;
flat in float tile_probability;
layout(location = 0) out vec4 direct_prediction; // in alpha, upper bound of its luminance's increase
#if TRACE || CORRECT
layout(location = 1) out vec4 direct_residual; // in alpha, unshadowed luminance of the light, if it is uncertain
#endif
#if TRACE
layout(location = 2) out vec2 rays; // unoccluded, traced
#endif

#if TRACE
// What a ray adds to `rays`. Samples through portals are not distributed as the light that the surface reflects is, of
// luminance `unshadowed`: such a ray counts by what it estimates of it.
vec2 counts_of(vec3 visible, bool is_lit_from, ReflectionSample chosen, float unshadowed) {
#if PORTALS
    vec3 estimate = chosen.diffuse;
#if GLOSS
    estimate += chosen.gloss;
#endif
    float weight = unshadowed != 0.0 ? clamp(luminance(estimate) / unshadowed, 0.0, MAX_RAY_WEIGHT) : 1.0;
    return vec2(is_lit_from ? weight * mean(visible) : 0.0, 1.0);
#else
    return vec2(mean(visible), is_lit_from ? 1.0 : 0.0);
#endif
}
#endif

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    direct_prediction = vec4(0.0);
#if TRACE || CORRECT
    direct_residual = vec4(0.0);
#endif
#if TRACE
    rays = vec2(0.0);
#endif
    Surface surface = surface_at(at);
    if (!surface.exists) return;
    Light light = fetch_Light(scene_records, lights + tile_light);
    bool is_lit = is_lit_by(surface, light);
#if TRACE || CACHED
    PredictedPixel pixel = predicted_pixel(predicted_pixels, at);
#else
    PredictedPixel pixel = PredictedPixel(at, true);
#endif
#if CACHED
    CachedIrradiance cached = cached_irradiance(surface, light, at, pixel.similar ? pixel.at : ivec2(-1));
    float irradiance = cached.value;
    vec3 color = cached.color;
    bool is_reliable = cached.is_reliable;
#else
    float irradiance = light_irradiance(light, surface.position, surface.normal);
    vec3 color = light_mean_color(light, surface.position, surface.normal);
    const bool is_reliable = true;
#endif
    bool exact = TRACE == 0 || (EXACT == 1 && is_reliable); // without rays, nothing better corrects it
    vec3 unshadowed = is_lit ? unshadowed_diffuse(surface, light, irradiance, color) : vec3(0.0);
    vec2 predicted = fetch(prediction, min(pixel.at, textureSize(prediction, 0) - 1)).xy;
    if (tile_visibility >= 0.0) predicted = vec2(tile_visibility, float(light.casts_shadow));
#if TRACE
    if (!pixel.similar) predicted.y = 1.0;
#endif
    vec3 all_unshadowed = unshadowed;
#if GLOSS
    Lobes lobes = lobes_at(at, surface, direction_to_camera(surface.position));
    LobePrediction prediction_of_lobes = predict_lobes(surface, lobes, light, irradiance, color);
    vec3 glossy = is_lit ? prediction_of_lobes.radiance : vec3(0.0);
    bool exact_gloss = prediction_of_lobes.even == EVERYWHERE;
    bool corrects_gloss = is_lit && lobes.exist && !exact_gloss && !light_is_delta(light, surface.position);
    all_unshadowed += glossy;
#endif
    float amount = luminance(all_unshadowed);
    bool uncertain = !exact || predicted.y > 0.0;
    direct_prediction = vec4(all_unshadowed * predicted.x, uncertain ? headroom(amount, predicted.x, exact) : 0.0);
#if MESHES_WITH_BVH && TRACE
    float most = brightest(light) * luminance(unshadowed_diffuse(surface, light, 1.0 / INVERSE_PI, color)); // all around
    if (!exact) direct_prediction.a = max(most, 0.0) - amount * predicted.x;
#endif
#if HARD
    bool decides = uncertain && amount != 0.0; // one ray decides: nothing is left to correct
    if (decides) {
        LightSample from = light_sample(light, surface.position, surface.normal, vec2(0.5));
        vec3 visible = shadow_transmittance(surface, from.point, light);
        predicted.x = mean(visible);
        direct_prediction = vec4(all_unshadowed * visible, 0.0);
#if TRACE
        rays = vec2(predicted.x, 1.0);
#endif
#if !GLOSS
        return;
#endif
    }
#endif
#if TRACE || CORRECT
    // If the prediction is certain, a ray only tests it: a correction of weight 1 / probability would be too noisy.
    bool tests = tile_probability > 0.0;
    float rate = 1.0, count = 0.0;
    ScheduledRays scheduled = ScheduledRays(0.0, 0.0);
#if TRACE
    direct_residual.a = uncertain ? abs(amount) : 0.0;
    rate = tests ? tile_probability : ray_rate(amount, predicted.x, uncertain);
    scheduled = schedule_rays(at, light_uv_shift.z, rate);
    bool has_light = all_unshadowed != vec3(0.0);
#if GLOSS
    has_light = has_light || corrects_gloss;
#endif
    if (!is_lit || (exact && !has_light)) return;
    count = tests ? 1.0 : scheduled.count;
#if HARD && GLOSS
    if (decides) {
        direct_residual.a = count = 0.0;
        uncertain = true;
    }
#endif
#endif
    float samples = count;
#if GLOSS
    vec3 corrections = vec3(0.0);
    if (corrects_gloss) {
        samples = max(count, 1.0);
        direct_prediction.a = 1e30; // the correction has no bound
        direct_residual.a = max(direct_residual.a, correctable_luminance(lobes, unshadowed, glossy));
        if (count == 0.0) scheduled.first = RAYLESS + sample_index;
    }
#endif
    for (float k = 0.0; k < samples; ++k) {
        vec2 light_uv = pixel_sequence(at, light_uv_shift.xy + ray_shift(scheduled.first + k));
#if GLOSS
        vec3 lobe_uv = lobe_sequence(at, lobe_shift, uint(scheduled.first + k));
        ReflectionSample chosen =
            reflection_sample(surface, lobes, prediction_of_lobes, light, light_uv, lobe_uv, irradiance, color);
        corrections += chosen.correction;
#else
        ReflectionSample chosen = reflection_sample(surface, light, light_uv, irradiance);
#endif
#if TRACE
        LightSample from = chosen.from;
        bool is_lit_from = arrives(surface, from);
        if (k >= count || (exact && PORTALS == 0 && !is_lit_from)) continue;
        vec3 visible = is_lit_from ? shadow_transmittance(surface, from.point, light) : vec3(0.0);
        rays += counts_of(visible, is_lit_from, chosen, amount);
        if (tests) continue;
        vec3 estimate = is_lit_from ? chosen.diffuse : vec3(0.0);
        vec3 correction = ray_correction(
            estimate, visible, unshadowed, predicted.x, light, surface.position, from.point, is_reliable);
#if GLOSS
        vec3 gloss = is_lit_from ? chosen.gloss : vec3(0.0);
        correction += gloss * visible - predicted.x * (PORTALS != 0 && exact_gloss ? glossy : gloss);
#endif
        direct_residual.rgb += correction / rate;
#endif
    }
#if TRACE
    if (!uncertain) { // what contradicts a certain prediction is uncertain
        float change = luminance(direct_residual.rgb);
        direct_residual.a = max(direct_residual.a, abs(change));
        direct_prediction.a = max(direct_prediction.a, clamp(change, 0.0, headroom(amount, predicted.x, exact)));
    }
#endif
#if GLOSS
    if (corrects_gloss) direct_residual.rgb += predicted.x * corrections / samples;
#endif
#endif
}
