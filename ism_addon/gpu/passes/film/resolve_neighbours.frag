// Corrections as neighbours that look alike have them, and how both stand to their noise.
#include "maths/luminance.glsl"
uniform sampler2D sum_color; // as predicted
uniform sampler2D sum_residual; // in alpha, the squares of their weighted luminances
uniform sampler2D sum_weights;
uniform sampler2D tile_sample_counts;
layout(location = 0) out vec4 neighbour_mean;      // mean of the corrections; in alpha, the weight of the own ones
layout(location = 1) out vec4 signal_and_noise; // squared luminance and variance of the own one's difference, and of the mean

// Of the corrections: all samples but the first have one.
float residual_weight(ivec2 at, float weight, vec2 texel) {
    float count = fetch(tile_sample_counts, at / TILE_SIZE, texel).x;
    return max(weight * (count - 1.0) / count, 1e-30);
}

// Of two luminances: 1 where they are one, little where one is twice the other.
float luminance_similarity(float a, float b) {
    float apart = (a - b) / max(a + b, 1e-37), square = 1.0 + SIMILARITY_SHARPNESS * apart * apart;
    return 1.0 / (square * square);
}

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy), last = last_pixel();
    vec4 own_sums = fetch(sum_weights, at);
    float own_luminance = luminance(fetch(sum_color, at).rgb) / own_sums.y;
    vec2 texel = texel_size(sum_color), texel_of_counts = texel_size(tile_sample_counts);
    float all = 0.0, squares = 0.0, in_doubt = 0.0, own_weight = residual_weight(at, own_sums.y, texel_of_counts);
    neighbour_mean = vec4(0.0);
    for (int k = 0; k < 9; ++k) {
        ivec2 other = clamp(at + ivec2(k % 3 - 1, k / 3 - 1), ivec2(0), last);
        vec2 theirs = fetch(sum_weights, other, texel).yw;
        float alike = luminance_similarity(own_luminance, luminance(fetch(sum_color, other, texel).rgb) / theirs.x);
        float weight = residual_weight(other, theirs.x, texel_of_counts);
        neighbour_mean += alike * fetch(sum_residual, other, texel);
        all += alike * weight;
        in_doubt += alike * theirs.y;
        squares += alike * alike * weight * weight;
    }
    // A part of what is in doubt, so that the edges of textures stay.
    neighbour_mean *= in_doubt > 1e-37 ? own_sums.w / (own_weight * in_doubt) : 1.0 / all;
    vec4 correction = fetch(sum_residual, at) / own_weight;
    float difference = luminance(correction.rgb - neighbour_mean.rgb), mean = luminance(neighbour_mean.rgb), variance = correction.a / own_weight;
    // As many alike would have this size and these squares: one that stands for many samples is still one.
    variance *= pow(max(own_sums.z * own_sums.z / max(correction.a * own_weight, 1e-37), 1.0), -STRATIFICATION_EXPONENT);
    neighbour_mean.a = own_weight;
    signal_and_noise = vec4(difference * difference, variance * (1.0 - own_weight / all),
                     mean * mean, variance * squares / (all * all));
}
