// The mean of the samples, with their corrections as far as those stand out of their noise.
#include "maths/luminance.glsl"
uniform sampler2D sum;
uniform sampler2D sum_correction;
uniform sampler2D weights;
uniform sampler2D sum_headroom;
uniform sampler2D counts;
uniform float least;          // light that there can be
uniform sampler2D near;      // see resolve_neighbours.frag
uniform sampler2D stand_out;
out vec4 resolved;

// What is left of squares when their noise is taken out.
float shrinkage(float square, float noise) { return square > 0.0 ? max(1.0 - noise / square, 0.0) : 1.0; }

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy), last = last_pixel();
    resolved = fetch(sum, at) / fetch(weights, at).y;
#if CORRECTED
    // For those processors that walk through both sides of every "if", but skip empty loops.
    bool corrected = fetch(counts, at / TILE_SIZE).x > 1.0;
    int last_row = corrected ? 2 : -3;
    vec4 found = vec4(0.0);
    vec2 texel = texel_size(stand_out);
    for (int y = -2; y <= last_row; ++y) {
        for (int x = -2; x <= 2; ++x)
            found += fetch(stand_out, clamp(at + ivec2(x, y), ivec2(0), last), texel);
    }
    vec4 mean = fetch(near, at);
    vec3 difference = fetch(sum_correction, at).rgb / mean.a - mean.rgb;
    vec3 change = shrinkage(found.z, found.w) * mean.rgb + shrinkage(found.x, found.y) * difference;
    // No correction adds light beyond what would arrive if nothing hid it, takes more than is in doubt, or than there is.
    float amount = luminance(change), all = fetch(weights, at).y;
    float most = amount > 0.0 ? fetch(sum_headroom, at).x / all : fetch(weights, at).w / mean.a;
    change *= min(most / max(abs(amount), 1e-37), 1.0);
    if (corrected) resolved.rgb = max(resolved.rgb + change, min(resolved.rgb, least));
#endif
}
