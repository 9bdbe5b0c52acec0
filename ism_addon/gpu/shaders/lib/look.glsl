// One ray to a light from one of the pixels that a coarser pixel stands for.
#include "lib/receiver.glsl"
#include "lib/shadow_ray.glsl"
uniform samplerBuffer lights;
uniform ivec2 offset; // of the pixel

// Rays that arrived, and rays. `place` is that on the light, for the first of the pixels.
vec2 look(int light_index, vec2 place, ivec2 coarse, int apart) {
    Receiver here = receiver_at(min(apart * coarse + offset, textureSize(position, 0) - 1));
    if (!here.seen) return vec2(0.0);
    Light light = fetch_Light(lights, light_index);
    if (!receives(here, light)) return vec2(0.0);
    vec3 to = light.position + point_on_light(light, place_of_pixel(coarse, place));
    return sent(light, to - here.position, here.normal) > 0.0 ? vec2(sees(here, to, light) ? 1.0 : 0.0, 1.0) : vec2(0.0);
}
