// Irradiance cache of one light: the ratio of its unshadowed irradiance to the estimate that shaders use. FINE: at each
// pixel of tiles near the light.
#include "surfaces/surface.glsl"
#include "lights/light.glsl"
uniform int light_index;
#if !FINE
uniform sampler2D needed; // by tile: whether the ratio is
uniform int fine_width;   // of the fine part, beside which the coarse one is
#endif
out vec4 irradiance_ratio; // and the mean colour, if the light has colours

void main() {
#if FINE
    ivec2 at = ivec2(gl_FragCoord.xy);
    bool is_needed = true;
#else
    ivec2 at = min(CACHE_SPACING * (ivec2(gl_FragCoord.xy) - ivec2(fine_width, 0)), last_pixel());
    bool is_needed = fetch(needed, at / TILE_SIZE).x > 0.0;
#endif
    Surface surface = surface_at(at);
    irradiance_ratio = vec4(NO_RATIO);
    if (!surface.exists || !is_needed || surface.base_color == vec3(0.0)) return;
    Light light = fetch_Light(scene_records, lights + light_index);
    float estimate = estimate_light_bvh(light, surface.position, surface.normal, CACHED_NODES).x;
    vec4 accurate = emissive_mesh_accurate_irradiance(light, surface.position, surface.normal);
    float ratio = min(accurate.x / max(estimate, 1e-30), MAX_RATIO), unlit = estimate > 0.0 ? 0.0 : 1.0;
    irradiance_ratio = vec4(accurate.x <= 0.0 ? unlit : ratio, mean_color(accurate));
}
