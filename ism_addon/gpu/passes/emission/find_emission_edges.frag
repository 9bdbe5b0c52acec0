// The largest difference of emission among the samples that are filtered to a tile's pixels.
#include "textures/tile_index.glsl"
#include "maths/luminance.glsl"
uniform sampler2D sample_emission;
out float emission_contrast;

void main() {
    ivec2 first = tile_index() * TILE_SIZE - MARGIN, last = last_pixel();
    vec2 texel = texel_size(sample_emission);
    vec3 low = vec3(1e38), high = vec3(-1e38);
    for (int y = 0; y < TILE_SIZE + 2 * MARGIN; ++y) {
        for (int x = 0; x < TILE_SIZE + 2 * MARGIN; ++x) {
            vec3 emission = fetch(sample_emission, clamp(first + ivec2(x, y), ivec2(0), last), texel).rgb;
            low = min(low, emission);
            high = max(high, emission);
        }
    }
    emission_contrast = luminance(high - low);
}
