// What part of a light a pixel sees, by the rays of its neighbours on the same surface.
#include "lib/surface.glsl"

uniform sampler2D scouted; // by the pixels that scouted: rays that arrived, and rays
uniform sampler2D seen;    // at full resolution, if there are any yet
uniform bool traced;
out vec2 prediction; // part of the light, and whether that is in doubt

const int TAPS = 25;

ivec2 neighbour(ivec2 at, int k, sampler2D of) {
    return clamp(at + ivec2(k % 5 - 2, k / 5 - 2), ivec2(0), textureSize(of, 0) - 1);
}

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy), size = textureSize(position, 0);
    int more = traced ? TAPS : 0;
    Surface here = surface_at(at);
    vec2 all = vec2(0.0), near = vec2(0.0);
    for (int k = 0; k < TAPS; ++k) {
        ivec2 other = neighbour(at / SCOUTS_APART, k, scouted);
        vec2 found = texelFetch(scouted, other, 0).xy;
        all += found;
        near += alike(here, min(SCOUTS_APART * other, size - 1)) * found;
    }
    for (int k = 0; k < more; ++k) {
        ivec2 other = neighbour(at, k, seen);
        vec2 found = texelFetch(seen, other, 0).xy;
        all += found;
        near += alike(here, other) * found;
    }
    bool sure = all.x == 0.0 || all.x == all.y || !here.seen;
    if (near.y < 1e-3) near = all;
    prediction = sure ? vec2(all.x > 0.0 ? 1.0 : 0.0, 0.0) : vec2(near.x / near.y, 1.0);
}
