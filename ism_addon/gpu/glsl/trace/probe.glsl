// One ray to a light from one of the pixels that a coarser pixel stands for.
#include "surfaces/receiver_linking.glsl"
#include "trace/shadow_ray.glsl"
uniform usamplerBuffer lights;
uniform ivec2 pixel_offset; // of the pixel among those

// Rays that arrived, and rays. `light_uv` is that of the first of the pixels. Where the light sends something, but not
// from the point that was drawn, nothing is known: that is half a ray. Where it sends nothing there is none.
vec2 probe(int index, uvec2 light_uv, ivec2 coarse, int spacing) {
    Surface surface = surface_at(min(spacing * coarse + pixel_offset, last_pixel()));
    if (!surface.exists) return vec2(0.0);
    Light light = fetch_Light(lights, index);
    if (!is_lit_by(surface, light)) return vec2(0.0, 1.0);
    LightSample from = light_sample(light, surface.position, surface.normal, pixel_sequence(coarse, light_uv));
    if (arrives(surface, from)) return vec2(is_unoccluded(surface, from.point, light) ? 1.0 : 0.0, 1.0);
    return light_irradiance(light, surface.position, surface.normal) > 0.0 ? vec2(0.5, 1.0) : vec2(0.0);
}
