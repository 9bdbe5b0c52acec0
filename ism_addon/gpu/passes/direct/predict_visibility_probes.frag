// Predicted visibility of a light at a probe, from the rays of its neighbours on the same surface.
#include "surfaces/surface.glsl"
uniform sampler2D probes;     // rays: unoccluded, traced
uniform sampler2D ray_counts; // the same at full resolution
uniform bool traced;          // whether ray_counts has any
out vec2 prediction;          // visibility, whether it is uncertain

const int RADIUS = 2; // taps to each side

float tent(ivec2 tap) { vec2 weight = 1.0 - vec2(abs(tap)) / float(RADIUS + 1); return weight.x * weight.y; }

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy), last = last_pixel(), last_probe = last / PROBE_SPACING;
    ivec2 pixel = min(PROBE_SPACING * at, last);
    int last_row = traced ? RADIUS : -RADIUS - 1; // of the loop over full resolution
    Surface surface = surface_at(pixel);
    vec2 total = vec2(0.0), similar = vec2(0.0);
    vec2 texel = texel_size(position), probe_texel = texel_size(probes);
    for (int y = -RADIUS; y <= RADIUS; ++y) {
        for (int x = -RADIUS; x <= RADIUS; ++x) {
            ivec2 other = clamp(at + ivec2(x, y), ivec2(0), last_probe);
            vec2 counts = fetch(probes, other, probe_texel).xy;
            total += counts;
            similar += tent(ivec2(x, y)) * similarity(surface, min(PROBE_SPACING * other, last), texel) * counts;
        }
    }
    for (int y = -RADIUS; y <= last_row; ++y) {
        for (int x = -RADIUS; x <= RADIUS; ++x) {
            ivec2 other = clamp(pixel + ivec2(x, y), ivec2(0), last);
            vec2 counts = fetch(ray_counts, other, texel).xy; // its texels are those of `position`
            total += counts;
            similar += tent(ivec2(x, y)) * similarity(surface, other, texel) * counts;
        }
    }
    bool certain = total.x == 0.0 || total.x == total.y || !surface.exists;
    if (similar.y < 1e-3) similar = total;
    prediction = certain ? vec2(total.x > 0.0 ? 1.0 : 0.0, 0.0) : vec2(min(similar.x / similar.y, 1.0), 1.0);
    if (total.y == 0.0 && surface.exists) prediction = vec2(0.5, 1.0); // no ray was traced: visibility is unknown
}
