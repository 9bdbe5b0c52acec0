// One ray to a light from one of the pixels that a coarser pixel stands for.
#include "surfaces/receiver.glsl"
#include "trace/shadow_ray.glsl"
uniform samplerBuffer lights;
uniform ivec2 offset; // of the pixel

// Rays that arrived, and rays. `place` is that on the light, for the first of the pixels. Where the light sends something,
// but not from the point that was drawn, nothing is known: that is half a ray. Where it sends nothing there is none.
vec2 look(int light_index, uvec2 place, ivec2 coarse, int apart) {
    Receiver here = receiver_at(min(apart * coarse + offset, last_pixel()));
    if (!here.seen) return vec2(0.0);
    Light light = fetch_Light(lights, light_index);
    if (!receives(here, light)) return vec2(0.0, 1.0);
    LightSample sampled = sample_light(light, here.position, here.normal, pixel_sequence(coarse, place));
    if (sampled.irradiance > 0.0) return vec2(sees(here, sampled.point, light) ? 1.0 : 0.0, 1.0);
    return unshadowed_irradiance(light, here.position, here.normal) > 0.0 ? vec2(0.5, 1.0) : vec2(0.0);
}
