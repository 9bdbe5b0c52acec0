// A faint light: one predicted visibility for all pixels of a tile.
#include "surfaces/receiver_linking.glsl"
#include "trace/ray_scheduling.glsl"
#include "lights/reflection_sample.glsl"
#include "trace/ray_correction.glsl"
uniform uvec3 light_steps;
flat in int tile_light;
flat in float tile_visibility;
flat in float tile_probability;
layout(location = 0) out vec4 direct_prediction; // see trace_shadows.frag
layout(location = 1) out vec4 direct_residual;

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    direct_prediction = direct_residual = vec4(0.0);
    Surface surface = surface_at(at);
    if (!surface.exists) return;
    Light light = fetch_Light(scene_records, lights + tile_light);
    if (!is_lit_by(surface, light)) return;
    float visibility = tile_visibility;
    const bool exact = TRACE == 0 || EXACT == 1; // without rays, nothing better corrects it
    float irradiance = light_irradiance(light, surface.position, surface.normal);
    vec3 color = light_mean_color(light, surface.position, surface.normal);
    vec3 unshadowed = unshadowed_diffuse(surface, light, irradiance, color) / tile_probability;
    vec3 all_unshadowed = unshadowed;
#if GLOSS
    Lobes lobes = lobes_at(at, surface, direction_to_camera(surface.position));
    LobePrediction prediction = predict_lobes(surface, lobes, light, irradiance, color);
    vec3 glossy = prediction.radiance / tile_probability;
    bool corrects_gloss = lobes.exist && !light_is_delta(light, surface.position);
    all_unshadowed += glossy;
#else
    const bool corrects_gloss = false;
#endif
    float amount = luminance(all_unshadowed); // always uncertain: the prediction is from few rays
    bool casts_shadow = light.casts_shadow != 0;
    direct_prediction = vec4(all_unshadowed * visibility, casts_shadow ? headroom(amount, visibility, exact) : 0.0);
#if TRACE || CORRECT
    if (!corrects_gloss && (!casts_shadow || (exact && all_unshadowed == vec3(0.0)))) return;
    uvec3 start = uint(tile_light + 1) * light_steps;
    float rate = 1.0;
    ScheduledRays scheduled = ScheduledRays(0.0, 0.0);
#if TRACE
    if (casts_shadow) {
        direct_residual.a = abs(amount);
        rate = ray_rate(amount, visibility, !exact || visibility < 1.0);
        // So there are as many rays on average as if all samples drew the light.
        rate = max(min(rate, 1.0), MIN_PROBABILITY / tile_probability);
        scheduled = schedule_rays(at, start.z, rate);
    }
#endif
    bool has_ray = scheduled.count > 0.0;
    if (!has_ray && !corrects_gloss) return;
    if (!has_ray) scheduled.first = RAYLESS + sample_index;
    vec2 light_uv = pixel_sequence(at, start.xy + ray_shift(scheduled.first));
#if GLOSS
    vec3 lobe_uv = lobe_sequence(at, uint(tile_light + 1) * lobe_light_steps, uint(scheduled.first));
    ReflectionSample chosen = reflection_sample(surface, lobes, prediction, light, light_uv, lobe_uv, irradiance, color);
    if (corrects_gloss) {
        direct_prediction.a = 1e30; // the correction has no bound
        direct_residual.a = max(direct_residual.a, correctable_luminance(lobes, unshadowed, glossy));
        direct_residual.rgb = visibility * chosen.correction / tile_probability;
    }
#else
    ReflectionSample chosen = reflection_sample(surface, light, light_uv, irradiance);
#endif
#if TRACE
    LightSample from = chosen.from;
    bool is_lit_from = arrives(surface, from);
    if (!has_ray || (exact && !is_lit_from)) return;
    vec3 visible = is_lit_from ? shadow_transmittance(surface, from.point, light) : vec3(0.0);
    vec3 estimate = is_lit_from ? chosen.diffuse / tile_probability : vec3(0.0);
    vec3 correction =
        ray_correction(estimate, visible, unshadowed, visibility, light, surface.position, from.point, true);
#if GLOSS
    if (is_lit_from) correction += chosen.gloss * ((visible - visibility) / tile_probability);
#endif
    direct_residual.rgb = direct_residual.rgb + correction / rate;
#endif
#endif
}
