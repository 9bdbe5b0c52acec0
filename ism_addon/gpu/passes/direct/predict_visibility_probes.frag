// Visibility of a light at a probe, by the rays of its neighbours on the same surface.
#include "surfaces/surface.glsl"
uniform sampler2D probes;     // rays that arrived, and rays
uniform sampler2D ray_counts; // the same at full resolution, if any were traced yet
uniform bool traced;
out vec2 prediction; // visibility, and whether that is uncertain

const int REACH = 2; // taps to each side

// What is near counts more.
float tent(ivec2 tap) { vec2 near = 1.0 - vec2(abs(tap)) / float(REACH + 1); return near.x * near.y; }

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy), last = last_pixel(), last_probe = last / PROBE_SPACING;
    ivec2 own = min(PROBE_SPACING * at, last);
    int last_row = traced ? REACH : -REACH - 1; // of full resolution
    Surface surface = surface_at(own);
    vec2 all = vec2(0.0), near = vec2(0.0);
    vec2 texel = texel_size(position), probe_texel = texel_size(probes);
    for (int y = -REACH; y <= REACH; ++y) {
        for (int x = -REACH; x <= REACH; ++x) {
            ivec2 other = clamp(at + ivec2(x, y), ivec2(0), last_probe);
            vec2 found = fetch(probes, other, probe_texel).xy;
            all += found;
            near += tent(ivec2(x, y)) * similarity(surface, min(PROBE_SPACING * other, last), texel) * found;
        }
    }
    for (int y = -REACH; y <= last_row; ++y) {
        for (int x = -REACH; x <= REACH; ++x) {
            ivec2 other = clamp(own + ivec2(x, y), ivec2(0), last);
            vec2 found = fetch(ray_counts, other, texel).xy; // of the picture's size, as positions are
            all += found;
            near += tent(ivec2(x, y)) * similarity(surface, other, texel) * found;
        }
    }
    bool sure = all.x == 0.0 || all.x == all.y || !surface.exists;
    if (near.y < 1e-3) near = all;
    prediction = sure ? vec2(all.x > 0.0 ? 1.0 : 0.0, 0.0) : vec2(near.x / near.y, 1.0);
    if (all.y == 0.0 && surface.exists) prediction = vec2(0.5, 1.0); // no light was sent to any of them: nothing is known
}
