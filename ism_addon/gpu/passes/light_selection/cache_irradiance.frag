// Irradiance cache of one light: the ratio of its unshadowed irradiance to the estimate that shaders use.
#include "surfaces/surface.glsl"
#include "lights/light.glsl"
uniform usamplerBuffer lights;
uniform int light_index;
uniform sampler2D needed; // by tile: whether the ratio is
out float irradiance_ratio;

const float MAX_RATIO = 4.0; // near a horizon

void main() {
    ivec2 at = min(CACHE_SPACING * ivec2(gl_FragCoord.xy), last_pixel());
    Surface surface = surface_at(at);
    irradiance_ratio = NO_RATIO;
    if (!surface.exists || fetch(needed, at / TILE_SIZE).x == 0.0) return;
    Light light = fetch_Light(lights, light_index);
    float estimate = estimate_light_bvh(light, surface.position, surface.normal, 1);
    if (estimate <= 0.0) {
        irradiance_ratio = 1.0;
        return;
    }
    float accurate = emissive_mesh_accurate_irradiance(light, surface.position, surface.normal);
    irradiance_ratio = min(accurate / estimate, MAX_RATIO);
}
