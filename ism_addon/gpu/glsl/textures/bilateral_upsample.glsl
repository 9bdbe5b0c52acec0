// Between the pixels of a coarser target, as far as they show the same surface.
#include "surfaces/surface.glsl"

struct UpsampleTap { ivec2 at; float weight; };

// One of the four nearest in a target that has a texel for every `spacing` pixels along either side: bilinear.
UpsampleTap upsample_tap(int k, ivec2 at, Surface surface, int spacing) {
    vec2 offset = vec2(at % spacing) / float(spacing);
    ivec2 step = ivec2(k & 1, k >> 1), other = min(at / spacing + step, last_pixel() / spacing);
    vec2 near = mix(1.0 - offset, offset, vec2(step));
    ivec2 pixel = min(spacing * other, last_pixel());
    return UpsampleTap(other, near.x * near.y * (similarity(surface, pixel, texel_size(position)) + 1e-4));
}
