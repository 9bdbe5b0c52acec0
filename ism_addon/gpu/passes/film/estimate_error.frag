// Means over a tile's pixels of their squared differences and of their brightness.
#include "textures/tile_index.glsl"
uniform sampler2D image;
uniform sampler2D half_samples_image;
out vec2 difference_and_mean;

void main() {
    ivec2 tile = tile_index(), last = last_pixel();
    vec2 texel = texel_size(image), earlier_texel = texel_size(half_samples_image);
    difference_and_mean = vec2(0.0);
    for (int k = 0; k < TILE_SIZE * TILE_SIZE; ++k) {
        ivec2 at = min(tile * TILE_SIZE + ivec2(k % TILE_SIZE, k / TILE_SIZE), last);
        vec3 color = fetch(image, at, texel).rgb, difference = color - fetch(half_samples_image, at, earlier_texel).rgb;
        difference_and_mean += vec2(dot(difference, difference), dot(abs(color), vec3(1.0))) / 3.0;
    }
    difference_and_mean /= float(TILE_SIZE * TILE_SIZE);
}
