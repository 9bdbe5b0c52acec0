// Mean residual of similar neighbours; squares of it and of the pixel's difference from it, with their noise.
#include "maths/luminance.glsl"
uniform sampler2D sum_color; // as predicted
uniform sampler2D sum_residual; // in alpha, the squares of their weighted norms
uniform sampler2D sum_weights;
layout(location = 0) out vec4 neighbour_mean;   // mean residual
layout(location = 1) out vec4 signal_and_noise; // squared norm and variance of the difference, and of the mean

// Similarity of two luminances: 1 if they are equal, small if one is twice the other. Lights can be negative.
float luminance_similarity(float a, float b) {
    float difference = (a - b) / max(abs(a) + abs(b), 1e-37), square = 1.0 + SIMILARITY_SHARPNESS * difference * difference;
    return 1.0 / (square * square);
}

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy), last = last_pixel();
    vec4 own_sums = fetch(sum_weights, at);
    float own_luminance = luminance(fetch(sum_color, at).rgb) / own_sums.y;
    vec2 texel = texel_size(sum_color);
    float weight_sum = 0.0, square_sum = 0.0, uncertain_sum = 0.0;
    neighbour_mean = vec4(0.0);
    for (int k = 0; k < 9; ++k) {
        ivec2 other = clamp(at + ivec2(k % 3 - 1, k / 3 - 1), ivec2(0), last);
        vec2 sums = fetch(sum_weights, other, texel).yw;
        float similarity = luminance_similarity(own_luminance, luminance(fetch(sum_color, other, texel).rgb) / sums.x);
        neighbour_mean += similarity * fetch(sum_residual, other, texel);
        weight_sum += similarity * sums.x;
        uncertain_sum += similarity * sums.y;
        square_sum += similarity * similarity * sums.x * sums.x;
    }
    // Scaled in proportion to the uncertain luminance, which keeps edges of textures.
    neighbour_mean *= uncertain_sum > 1e-37 ? own_sums.w / (own_sums.y * uncertain_sum) : 1.0 / weight_sum;
    vec4 residual = fetch(sum_residual, at) / own_sums.y;
    float variance = residual.a / own_sums.y;
    // Effective sample count: (sum |x|)^2 / sum x^2.
    variance *= pow(max(own_sums.z * own_sums.z / max(residual.a * own_sums.y, 1e-37), 1.0), -STRATIFICATION_EXPONENT);
    signal_and_noise = vec4(squared_norm(residual.rgb - neighbour_mean.rgb), variance * (1.0 - own_sums.y / weight_sum),
                     squared_norm(neighbour_mean.rgb), variance * square_sum / (weight_sum * weight_sum));
}
