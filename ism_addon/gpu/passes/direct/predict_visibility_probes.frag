// What part of a light a pixel that scouted sees, by the rays of its neighbours on the same surface.
#include "surfaces/surface.glsl"
uniform sampler2D scouted; // by the pixels that scouted: rays that arrived, and rays
uniform sampler2D seen;    // at full resolution, if there are any yet
uniform bool traced;
out vec2 prediction; // part of the light, and whether that is in doubt

const int REACH = 2; // taps to each side

// What is near counts more.
float tent(ivec2 tap) { vec2 near = 1.0 - vec2(abs(tap)) / float(REACH + 1); return near.x * near.y; }

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy), last = last_pixel(), last_scout = last / PROBE_SPACING;
    ivec2 own = min(PROBE_SPACING * at, last);
    int last_row = traced ? REACH : -REACH - 1; // of full resolution
    Surface here = surface_at(own);
    vec2 all = vec2(0.0), near = vec2(0.0);
    vec2 texel = texel_size(position), scouted_texel = texel_size(scouted);
    for (int y = -REACH; y <= REACH; ++y) {
        for (int x = -REACH; x <= REACH; ++x) {
            ivec2 other = clamp(at + ivec2(x, y), ivec2(0), last_scout);
            vec2 found = fetch(scouted, other, scouted_texel).xy;
            all += found;
            near += tent(ivec2(x, y)) * alike(here, min(PROBE_SPACING * other, last), texel) * found;
        }
    }
    for (int y = -REACH; y <= last_row; ++y) {
        for (int x = -REACH; x <= REACH; ++x) {
            ivec2 other = clamp(own + ivec2(x, y), ivec2(0), last);
            vec2 found = fetch(seen, other, texel).xy; // of the picture's size, as positions are
            all += found;
            near += tent(ivec2(x, y)) * alike(here, other, texel) * found;
        }
    }
    bool sure = all.x == 0.0 || all.x == all.y || !here.seen;
    if (near.y < 1e-3) near = all;
    prediction = sure ? vec2(all.x > 0.0 ? 1.0 : 0.0, 0.0) : vec2(near.x / near.y, 1.0);
    if (all.y == 0.0 && here.seen) prediction = vec2(0.5, 1.0); // no light was sent to any of them: nothing is known
}
