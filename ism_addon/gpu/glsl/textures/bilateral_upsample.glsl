// Joint bilateral upsampling: interpolates between those pixels of a coarser target that show the same surface.
#include "surfaces/surface.glsl"

struct UpsampleTap { ivec2 at; float weight; };

// One of the four bilinear taps in a target with a texel for every `spacing` pixels in x and in y.
UpsampleTap upsample_tap(int k, ivec2 at, Surface surface, int spacing) {
    vec2 offset = vec2(at % spacing) / float(spacing);
    ivec2 step = ivec2(k & 1, k >> 1), other = min(at / spacing + step, last_pixel() / spacing);
    vec2 weights = mix(1.0 - offset, offset, vec2(step));
    ivec2 pixel = min(spacing * other, last_pixel());
    return UpsampleTap(other, weights.x * weights.y * (similarity(surface, pixel, texel_size(position)) + 1e-4));
}
