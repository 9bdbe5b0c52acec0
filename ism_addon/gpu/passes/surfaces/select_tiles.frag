// Means over a tile's pixels of the variance of their samples and of their luminance.
#include "textures/tile_index.glsl"
#include "maths/luminance.glsl"
uniform sampler2D sum_color;
uniform sampler2D sum_residual;
uniform sampler2D sum_weights; // of squared luminances, and of samples
out vec2 variance_and_mean;

void main() {
    ivec2 tile = tile_index(), last = last_pixel();
    vec2 texel = texel_size(sum_color); // of all three
    variance_and_mean = vec2(0.0);
    for (int k = 0; k < TILE_SIZE * TILE_SIZE; ++k) {
        ivec2 pixel = min(tile * TILE_SIZE + ivec2(k % TILE_SIZE, k / TILE_SIZE), last);
        vec2 weight = fetch(sum_weights, pixel, texel).xy;
        float mean = luminance(fetch(sum_color, pixel, texel).rgb + fetch(sum_residual, pixel, texel).rgb) / weight.y;
        variance_and_mean += vec2(max(weight.x / weight.y - mean * mean, 0.0), abs(mean));
    }
    variance_and_mean /= float(TILE_SIZE * TILE_SIZE);
}
