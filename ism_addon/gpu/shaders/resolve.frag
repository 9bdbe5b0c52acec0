// The mean of the samples, with their corrections as far as those stand out of their noise.
#include "lib/luminance.glsl"
uniform sampler2D sum;
uniform sampler2D sum_correction; // in alpha, the sum of the squares of their luminances
uniform sampler2D counts;
out vec4 resolved;

// All samples but the first were corrected.
float corrections(ivec2 at) { return texelFetch(counts, at / BLOCK, 0).x - 1.0; }

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy), last = textureSize(sum, 0) - 1;
    float count = corrections(at);
    resolved = texelFetch(sum, at, 0) / (count + 1.0);
    if (count == 0.0) return;
    float square = 0.0, noise = 0.0;
    for (int k = 0; k < 25; ++k) {
        ivec2 other = clamp(at + ivec2(k % 5 - 2, k / 5 - 2), ivec2(0), last);
        vec4 tap = texelFetch(sum_correction, other, 0) / corrections(other);
        float bright = luminance(tap.rgb);
        square += bright * bright;
        noise += tap.a / corrections(other);
    }
    noise *= pow(count, -EVENNESS);
    float believed = square > 0.0 ? max(1.0 - noise / square, 0.0) : 1.0;
    resolved.rgb += believed * texelFetch(sum_correction, at, 0).rgb / count;
}
