// Of a block's pixels, the mean of their samples' variances, and of their luminances.
#include "lib/luminance.glsl"
uniform sampler2D sum;
uniform sampler2D sum_correction;
uniform sampler2D squares;
uniform sampler2D counts;
out vec2 noise;

void main() {
    ivec2 block = ivec2(gl_FragCoord.xy), last = textureSize(sum, 0) - 1;
    float count = texelFetch(counts, block, 0).x;
    noise = vec2(0.0);
    for (int k = 0; k < BLOCK * BLOCK; ++k) {
        ivec2 at = min(block * BLOCK + ivec2(k % BLOCK, k / BLOCK), last);
        float mean = luminance(texelFetch(sum, at, 0).rgb + texelFetch(sum_correction, at, 0).rgb) / count;
        noise += vec2(max(texelFetch(squares, at, 0).x / count - mean * mean, 0.0), mean);
    }
    noise /= float(BLOCK * BLOCK);
}
