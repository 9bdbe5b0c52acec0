// Corrections as neighbours that look alike have them, and how both stand to their noise.
#include "maths/luminance.glsl"
uniform sampler2D sum; // as predicted
uniform sampler2D sum_correction; // in alpha, the squares of their weighted luminances
uniform sampler2D weights;
uniform sampler2D counts;
layout(location = 0) out vec4 near;      // mean of the corrections; in alpha, the weight of the own ones
layout(location = 1) out vec4 stand_out; // squared luminance and variance of the own one's difference, and of the mean

// Of the corrections: all samples but the first have one.
float corrected(ivec2 at, float weight, vec2 texel) {
    float count = fetch(counts, at / TILE_SIZE, texel).x;
    return max(weight * (count - 1.0) / count, 1e-30);
}

// Of two luminances: 1 where they are one, little where one is twice the other.
float alike(float a, float b) {
    float apart = (a - b) / max(a + b, 1e-37), square = 1.0 + SIMILARITY_SHARPNESS * apart * apart;
    return 1.0 / (square * square);
}

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy), last = last_pixel();
    vec4 mine = fetch(weights, at);
    float bright = luminance(fetch(sum, at).rgb) / mine.y;
    vec2 texel = texel_size(sum), texel_of_counts = texel_size(counts);
    float all = 0.0, squares = 0.0, in_doubt = 0.0, own = corrected(at, mine.y, texel_of_counts);
    near = vec4(0.0);
    for (int k = 0; k < 9; ++k) {
        ivec2 other = clamp(at + ivec2(k % 3 - 1, k / 3 - 1), ivec2(0), last);
        vec2 theirs = fetch(weights, other, texel).yw;
        float like = alike(bright, luminance(fetch(sum, other, texel).rgb) / theirs.x);
        float weight = corrected(other, theirs.x, texel_of_counts);
        near += like * fetch(sum_correction, other, texel);
        all += like * weight;
        in_doubt += like * theirs.y;
        squares += like * like * weight * weight;
    }
    // A part of what is in doubt, so that the edges of textures stay.
    near *= in_doubt > 1e-37 ? mine.w / (own * in_doubt) : 1.0 / all;
    vec4 correction = fetch(sum_correction, at) / own;
    float difference = luminance(correction.rgb - near.rgb), mean = luminance(near.rgb), variance = correction.a / own;
    // As many alike would have this size and these squares: one that stands for many samples is still one.
    variance *= pow(max(mine.z * mine.z / max(correction.a * own, 1e-37), 1.0), -STRATIFICATION_EXPONENT);
    near.a = own;
    stand_out = vec4(difference * difference, variance * (1.0 - own / all),
                     mean * mean, variance * squares / (all * all));
}
