// Of a block's pixels, the mean of their squared differences, and of their brightness.
#include "textures/tile_index.glsl"
uniform sampler2D resolved;
uniform sampler2D earlier;
out vec2 moved;

void main() {
    ivec2 block = block_here(), last = last_pixel();
    vec2 texel = texel_size(resolved), earlier_texel = texel_size(earlier);
    moved = vec2(0.0);
    for (int k = 0; k < TILE_SIZE * TILE_SIZE; ++k) {
        ivec2 at = min(block * TILE_SIZE + ivec2(k % TILE_SIZE, k / TILE_SIZE), last);
        vec3 now = fetch(resolved, at, texel).rgb, difference = now - fetch(earlier, at, earlier_texel).rgb;
        moved += vec2(dot(difference, difference), dot(abs(now), vec3(1.0))) / 3.0;
    }
    moved /= float(TILE_SIZE * TILE_SIZE);
}
