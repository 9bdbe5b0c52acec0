// Of a block's pixels, the mean of their samples' variances, and of their luminances.
#include "textures/tile_index.glsl"
#include "maths/luminance.glsl"
uniform sampler2D sum;
uniform sampler2D sum_correction;
uniform sampler2D weights; // of squared luminances, and of samples
out vec2 noise;

void main() {
    ivec2 block = block_here(), last = last_pixel();
    vec2 texel = texel_size(sum); // of all three
    noise = vec2(0.0);
    for (int k = 0; k < TILE_SIZE * TILE_SIZE; ++k) {
        ivec2 at = min(block * TILE_SIZE + ivec2(k % TILE_SIZE, k / TILE_SIZE), last);
        vec2 weight = fetch(weights, at, texel).xy;
        float mean = luminance(fetch(sum, at, texel).rgb + fetch(sum_correction, at, texel).rgb) / weight.y;
        noise += vec2(max(weight.x / weight.y - mean * mean, 0.0), abs(mean));
    }
    noise /= float(TILE_SIZE * TILE_SIZE);
}
