// A light that is a small part of a tile's light: one visibility is predicted for all of the tile's pixels.
#include "maths/luminance.glsl"
#include "surfaces/receiver_linking.glsl"
#include "trace/ray_scheduling.glsl"
uniform samplerBuffer lights;
uniform uvec3 light_steps;
flat in float tile_light;
flat in float tile_visibility;
flat in float tile_probability;
layout(location = 0) out vec4 direct_prediction; // see trace_shadows.frag
layout(location = 1) out vec4 direct_residual;

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    direct_prediction = direct_residual = vec4(0.0);
    Surface surface = surface_at(at);
    if (!surface.exists) return;
    Light light = fetch_Light(lights, int(tile_light + 0.5));
    float visibility = tile_visibility, unshadowed = 0.0;
    if (is_lit_by(surface, light)) unshadowed = light_irradiance(light, surface.position, surface.normal);
    float scaled = unshadowed / tile_probability; // the rarer it is drawn, the more it counts
    float light_luminance = luminance(light.radiance); // all of it is in doubt: so few rays are no proof
    direct_prediction = scaled * vec4(light.radiance * visibility, light.casts_shadow == 0 ? 0.0 : headroom(light_luminance, visibility));
#if TRACE
    if (light.casts_shadow == 0 || unshadowed <= 0.0) return;
    direct_residual.a = scaled * abs(light_luminance);
    uvec3 start = (uint(tile_light + 0.5) + 1u) * light_steps;
    float probability = ray_probability(light.radiance, surface.base_color, scaled, visibility, visibility < 1.0);
    // As many rays as if the light were drawn in all samples.
    ScheduledRay ray = schedule_ray(at, start.z, max(probability, MIN_PROBABILITY / tile_probability));
    if (!ray.trace) return;
    vec2 light_uv = pixel_sequence(at, start.xy + uint(ray.index) * ray_steps);
    LightSample point = light_sample(light, surface.position, surface.normal, light_uv);
    if (point.irradiance <= 0.0) return;
    float visible = is_unoccluded(surface, point.point, light) ? 1.0 : 0.0;
    direct_residual.rgb = light.radiance * (point.irradiance / tile_probability * (visible - visibility) / ray.probability);
#endif
}
