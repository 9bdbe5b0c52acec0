// Whether any ray about a block arrived, and whether any did not.
#include "lib/block_here.glsl"
uniform sampler2D rays; // that arrived, and all
uniform int apart;      // pixels from one texel of them to the next
out vec2 found;

const int MARGIN = 2; // texels that the predictions of the block look beyond it

void main() {
    ivec2 block = block_here(), last = last_pixel() / apart;
    int width = BLOCK / apart, across = width + 2 * MARGIN;
    found = vec2(0.0);
    for (int k = 0; k < across * across; ++k) {
        vec2 tap = fetch(rays, clamp(block * width - MARGIN + ivec2(k % across, k / across), ivec2(0), last)).xy;
        found = max(found, vec2(tap.x, tap.y - tap.x));
    }
    found = vec2(greaterThan(found, vec2(0.0)));
}
