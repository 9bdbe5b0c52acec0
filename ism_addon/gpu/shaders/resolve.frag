// The mean of the samples, with their corrections as far as those stand out of their noise.
#include "lib/luminance.glsl"
uniform sampler2D sum;
uniform sampler2D sum_correction; // in alpha, the squares of their weighted luminances
uniform sampler2D weights;
uniform sampler2D counts;
out vec4 resolved;

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy), last = textureSize(sum, 0) - 1;
    vec2 own = texelFetch(weights, at, 0).yz;
    float corrections = texelFetch(counts, at / BLOCK, 0).x - 1.0; // all samples but the first were corrected
    resolved = texelFetch(sum, at, 0) / own.x;
    if (own.y == 0.0) return;
    float square = 0.0, noise = 0.0;
    for (int k = 0; k < 25; ++k) {
        ivec2 other = clamp(at + ivec2(k % 5 - 2, k / 5 - 2), ivec2(0), last);
        float weight = max(texelFetch(weights, other, 0).z, 1e-30);
        vec4 tap = texelFetch(sum_correction, other, 0) / weight;
        float bright = luminance(tap.rgb);
        square += bright * bright;
        noise += tap.a / weight;
    }
    noise *= pow(max(corrections, 1.0), -EVENNESS);
    float believed = square > 0.0 ? max(1.0 - noise / square, 0.0) : 1.0;
    resolved.rgb += believed * texelFetch(sum_correction, at, 0).rgb / own.y;
}
