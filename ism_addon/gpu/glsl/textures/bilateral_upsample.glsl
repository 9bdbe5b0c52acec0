// Between the pixels of a coarser target, as far as they show the surface that is here.
#include "surfaces/surface.glsl"

struct Neighbour { ivec2 at; float weight; };

// One of the four nearest in a target that has a pixel for every `apart` ones along either side: bilinear.
Neighbour neighbour(int k, ivec2 at, Surface here, int apart) {
    vec2 offset = vec2(at % apart) / float(apart);
    ivec2 step = ivec2(k & 1, k >> 1), other = min(at / apart + step, last_pixel() / apart);
    vec2 near = mix(1.0 - offset, offset, vec2(step));
    ivec2 stands_for = min(apart * other, last_pixel());
    return Neighbour(other, near.x * near.y * (alike(here, stands_for, texel_size(position)) + 1e-4));
}
