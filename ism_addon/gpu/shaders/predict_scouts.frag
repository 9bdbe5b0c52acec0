// What part of a light a pixel that scouted sees, by the rays of its neighbours on the same surface.
#include "lib/surface.glsl"
uniform sampler2D scouted; // by the pixels that scouted: rays that arrived, and rays
uniform sampler2D seen;    // at full resolution, if there are any yet
uniform bool traced;
out vec2 prediction; // part of the light, and whether that is in doubt

const int TAPS = 25;

ivec2 tap(int k) { return ivec2(k % 5, k / 5) - 2; }

// What is near counts more.
float tent(ivec2 tap) { vec2 near = 1.0 - vec2(abs(tap)) / 3.0; return near.x * near.y; }

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy), last = last_pixel(), last_scout = last / SCOUTS_APART;
    ivec2 own = min(SCOUTS_APART * at, last);
    int more = traced ? TAPS : 0;
    Surface here = surface_at(own);
    vec2 all = vec2(0.0), near = vec2(0.0);
    for (int k = 0; k < TAPS; ++k) {
        ivec2 other = clamp(at + tap(k), ivec2(0), last_scout);
        vec2 found = fetch(scouted, other).xy;
        all += found;
        near += tent(tap(k)) * alike(here, min(SCOUTS_APART * other, last)) * found;
    }
    for (int k = 0; k < more; ++k) {
        ivec2 other = clamp(own + tap(k), ivec2(0), last);
        vec2 found = fetch(seen, other).xy;
        all += found;
        near += tent(tap(k)) * alike(here, other) * found;
    }
    bool sure = all.x == 0.0 || all.x == all.y || !here.seen;
    if (near.y < 1e-3) near = all;
    prediction = sure ? vec2(all.x > 0.0 ? 1.0 : 0.0, 0.0) : vec2(near.x / near.y, 1.0);
    if (all.y == 0.0 && here.seen) prediction = vec2(0.5, 1.0); // no light was sent to any of them: nothing is known
}
