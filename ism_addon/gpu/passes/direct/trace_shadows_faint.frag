// A faint light: one predicted visibility for all pixels of a tile.
#define ESTIMATE_NODES 4 // of a light BVH: faint lights are not in the irradiance cache
#include "maths/luminance.glsl"
#include "surfaces/bsdf.glsl"
#include "surfaces/receiver_linking.glsl"
#include "trace/ray_scheduling.glsl"
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
    Light light = fetch_Light(lights, tile_light);
    if (!is_lit_by(surface, light)) return;
    float visibility = tile_visibility;
    float irradiance = light_irradiance(light, surface.position, surface.normal);
    vec3 unshadowed = bsdf_unshadowed(surface, light, irradiance) / tile_probability;
    float amount = luminance(unshadowed); // always uncertain: the prediction is from few rays
    direct_prediction = vec4(unshadowed * visibility, light.casts_shadow == 0 ? 0.0 : headroom(amount, visibility));
#if TRACE
    if (light.casts_shadow == 0 || (EXACT == 1 && unshadowed == vec3(0.0))) return;
    direct_residual.a = abs(amount);
    uvec3 start = uint(tile_light + 1) * light_steps;
    float rate = ray_rate(amount, visibility, EXACT == 0 || visibility < 1.0);
    // So there are as many rays on average as if all samples drew the light.
    rate = max(min(rate, 1.0), MIN_PROBABILITY / tile_probability);
    ScheduledRays scheduled = schedule_rays(at, start.z, rate);
    if (scheduled.count == 0.0) return;
    vec2 light_uv = pixel_sequence(at, start.xy + ray_shift(scheduled.first));
    LightSample from = light_sample(light, surface.position, surface.normal, light_uv);
    bool is_lit_from = arrives(surface, from);
    if (EXACT == 1 && !is_lit_from) return;
    float visible = is_lit_from && is_unoccluded(surface, from.point, light) ? 1.0 : 0.0;
    vec3 estimate = is_lit_from ? bsdf_estimate(surface, light, from) / tile_probability : vec3(0.0);
    vec3 correction =
        ray_correction(estimate, visible, unshadowed, visibility, light, surface.position, from.point, true);
    direct_residual.rgb = correction / rate;
#endif
}
