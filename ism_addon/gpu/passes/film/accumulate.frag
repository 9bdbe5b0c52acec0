// The samples of one block, added by blending to all pixels that they count for.
#include "maths/blackman_harris.glsl"
#include "maths/luminance.glsl"
uniform sampler2D color;
uniform sampler2D correction;
uniform sampler2D headroom; // see shade.frag
uniform sampler2D chances; // of blocks to take part, and with their own pixels: 0 for those that are settled
uniform float reach;        // px
flat in vec2 own_block;
flat in vec4 place;
layout(location = 0) out vec4 sum;
layout(location = 1) out vec4 sum_correction; // in alpha, squares of weighted luminances
layout(location = 2) out vec4 weights;        // of squared luminances, samples, corrections without sign, luminances in doubt
layout(location = 3) out float sum_headroom;

// Without a margin the samples themselves are spread like the filter.
float weight_at(float x) { return MARGIN == 0 ? 1.0 : blackman_harris(x, reach); }

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy), first = ivec2(own_block) * TILE_SIZE, last = min(first + TILE_SIZE - 1, last_pixel());
#if WHOLE // all other blocks have a sample at the same place, so no block needs others to add to its pixels
    first = ivec2(0);
    last = last_pixel();
#endif
    float share = fetch(chances, at / TILE_SIZE).y / fetch(chances, ivec2(own_block)).x;
    sum = sum_correction = weights = vec4(0.0);
    sum_headroom = 0.0;
    vec2 texel = texel_size(color), filters[2 * MARGIN + 1];
    for (int k = -MARGIN; k <= MARGIN; ++k)
        filters[k + MARGIN] = vec2(weight_at(float(k) + place.z), share * weight_at(float(k) + place.w));
    for (int y = -MARGIN; y <= MARGIN; ++y) {
        for (int x = -MARGIN; x <= MARGIN; ++x) {
            ivec2 from = at + ivec2(x, y);
            bool mine = all(greaterThanEqual(from, first)) && all(lessThanEqual(from, last));
            float weight = mine ? filters[x + MARGIN].x * filters[y + MARGIN].y : 0.0;
            from = clamp(from, first, last);
            vec4 sampled = fetch(color, from, texel), wrong = CORRECTED == 1 ? fetch(correction, from, texel) : vec4(0.0);
            float bright = luminance(sampled.rgb + wrong.rgb), amount = weight * luminance(wrong.rgb);
            sum += weight * sampled;
            sum_correction += vec4(weight * wrong.rgb, amount * amount);
            weights += weight * vec4(bright * bright, 1.0, abs(luminance(wrong.rgb)), wrong.a);
            sum_headroom += weight * fetch(headroom, from, texel).x;
        }
    }
}
