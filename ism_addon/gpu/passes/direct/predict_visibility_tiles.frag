// Whether any ray in or near a tile was unoccluded, and whether any was occluded.
#include "textures/tile_index.glsl"
uniform sampler2D rays; // unoccluded, traced
uniform int spacing;    // pixels from one texel of `rays` to the next
out vec2 any_ray;

const int MARGIN = 2; // texels beyond the tile that predictions read: RADIUS in predict_visibility_probes.frag

void main() {
    ivec2 tile = tile_index(), last = last_pixel() / spacing, side = ivec2(TILE_SIZE / spacing);
    ivec2 first = max(tile * side - MARGIN, 0), end = min((tile + 1) * side - 1 + MARGIN, last);
    vec2 texel = texel_size(rays);
    any_ray = vec2(0.0);
    for (int y = first.y; y <= end.y; ++y) {
        for (int x = first.x; x <= end.x; ++x) {
            vec2 tap = fetch(rays, ivec2(x, y), texel).xy;
            any_ray = max(any_ray, vec2(tap.x, tap.y - tap.x));
        }
    }
    any_ray = vec2(greaterThan(any_ray, vec2(0.0)));
}
