// One light at each pixel: its predicted radiance towards the camera, and in some samples a ray that corrects it. To a
// hard light, a ray replaces an uncertain prediction in each sample, the first one included.
#include "maths/luminance.glsl"
#include "surfaces/bsdf.glsl"
#include "surfaces/receiver_linking.glsl"
#include "lights/resampled_light_sample.glsl"
#include "trace/ray_scheduling.glsl"
#include "trace/ray_correction.glsl"
#include "surfaces/predicted_pixel.glsl"
#if CACHED
#include "textures/irradiance_cache.glsl"
#endif
uniform int light_index;
uniform sampler2D prediction;         // visibility, whether it is uncertain
uniform sampler2D predicted_pixels;   // see match_predictions.frag
uniform uvec3 light_uv_shift;         // of points on the light, of samples that trace rays
flat in float tile_probability;
layout(location = 0) out vec4 direct_prediction; // in alpha, upper bound of its luminance's increase
#if TRACE
layout(location = 1) out vec4 direct_residual; // in alpha, unshadowed luminance of the light, if it is uncertain
layout(location = 2) out vec2 rays;            // unoccluded, traced
#endif

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    direct_prediction = vec4(0.0);
#if TRACE
    direct_residual = vec4(0.0);
    rays = vec2(0.0);
#endif
    Surface surface = surface_at(at);
    if (!surface.exists) return;
    Light light = fetch_Light(lights, light_index);
    bool is_lit = is_lit_by(surface, light);
#if TRACE || CACHED
    PredictedPixel pixel = predicted_pixel(predicted_pixels, at);
#else
    PredictedPixel pixel = PredictedPixel(at, true);
#endif
#if CACHED
    CachedIrradiance cached = cached_irradiance(surface, light, at, pixel.similar ? pixel.at : ivec2(-1));
    float irradiance = cached.value;
    bool is_reliable = TRACE == 0 || cached.is_reliable; // without rays, nothing better corrects it
#else
    float irradiance = light_irradiance(light, surface.position, surface.normal);
    const bool is_reliable = true;
#endif
    bool exact = EXACT == 1 && is_reliable;
    vec3 unshadowed = is_lit ? bsdf_unshadowed(surface, light, irradiance) : vec3(0.0);
    vec2 predicted = fetch(prediction, min(pixel.at, textureSize(prediction, 0) - 1)).xy;
#if TRACE
    if (!pixel.similar) predicted.y = 1.0;
#endif
    float amount = luminance(unshadowed);
    bool uncertain = !exact || predicted.y > 0.0;
    direct_prediction = vec4(unshadowed * predicted.x, uncertain ? headroom(amount, predicted.x) : 0.0);
#if CACHED && TRACE
    float most = luminance(bsdf_unshadowed(surface, light, 1.0 / INVERSE_PI)); // from all directions
    if (!is_reliable) direct_prediction.a = max(most, 0.0) - amount * predicted.x;
#endif
#if HARD
    if (uncertain && amount != 0.0) { // one ray decides: nothing is left to correct
        LightSample from = light_sample(light, surface.position, surface.normal, vec2(0.5));
        float visible = is_unoccluded(surface, from.point, light) ? 1.0 : 0.0;
        direct_prediction = vec4(unshadowed * visible, 0.0);
#if TRACE
        rays = vec2(visible, 1.0);
#endif
        return;
    }
#endif
#if TRACE
    direct_residual.a = uncertain ? abs(amount) : 0.0;
    // If the prediction is certain, a ray only tests it: a correction of weight 1 / probability would be too noisy.
    bool tests = tile_probability > 0.0;
    float rate = tests ? tile_probability : ray_rate(amount, predicted.x, uncertain);
    ScheduledRays scheduled = schedule_rays(at, light_uv_shift.z, rate);
    if (!is_lit || (exact && unshadowed == vec3(0.0))) return;
    float count = tests ? 1.0 : scheduled.count;
    for (float k = 0.0; k < count; ++k) {
        vec2 light_uv = pixel_sequence(at, light_uv_shift.xy + ray_shift(scheduled.first + k));
        LightSample from = resampled_light_sample(light, surface.position, surface.normal, light_uv, irradiance);
        bool is_lit_from = arrives(surface, from);
        if (exact && !is_lit_from) continue;
        float visible = is_lit_from && is_unoccluded(surface, from.point, light) ? 1.0 : 0.0;
        rays += vec2(visible, is_lit_from ? 1.0 : 0.0);
        if (tests) continue;
        vec3 estimate = is_lit_from ? bsdf_estimate(surface, light, from) : vec3(0.0);
        vec3 correction = ray_correction(
            estimate, visible, unshadowed, predicted.x, light, surface.position, from.point, is_reliable);
        direct_residual.rgb += correction / rate;
    }
    if (!uncertain) { // what contradicts a certain prediction is uncertain
        float change = luminance(direct_residual.rgb);
        direct_residual.a = abs(change);
        direct_prediction.a = clamp(change, 0.0, headroom(amount, predicted.x));
    }
#endif
}
