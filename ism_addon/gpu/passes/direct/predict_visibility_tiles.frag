// Whether any ray about a block arrived, and whether any did not.
#include "textures/tile_index.glsl"
uniform sampler2D rays; // that arrived, and all
uniform int apart;      // pixels from one texel of them to the next
out vec2 found;

const int MARGIN = 2; // texels that the predictions of the block look beyond it

void main() {
    ivec2 block = block_here(), last = last_pixel() / apart;
    ivec2 first = max(block * (TILE_SIZE / apart) - MARGIN, 0), end = min((block + 1) * (TILE_SIZE / apart) - 1 + MARGIN, last);
    vec2 texel = texel_size(rays);
    found = vec2(0.0);
    for (int y = first.y; y <= end.y; ++y) {
        for (int x = first.x; x <= end.x; ++x) {
            vec2 tap = fetch(rays, ivec2(x, y), texel).xy;
            found = max(found, vec2(tap.x, tap.y - tap.x));
        }
    }
    found = vec2(greaterThan(found, vec2(0.0)));
}
