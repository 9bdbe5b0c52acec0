// Adds the samples of one tile, by blending, to all pixels whose filters cover them.
#include "maths/luminance.glsl"
#include "textures/pixel_filter.glsl"
uniform sampler2D sample_color;
uniform sampler2D sample_residual;
#if EMISSION
uniform sampler2D sample_emission;
#endif
#if FILTERED
uniform sampler2D filtered_emission; // in alpha its weight, 0 where it does not replace sample_emission
#endif
uniform sampler2D sample_headroom; // see shade.frag
uniform sampler2D tile_probabilities; // that a tile takes part; the same, but 0 for a converged tile
flat in vec2 tile;
flat in vec4 visibility_texel_and_offset;
layout(location = 0) out vec4 sum_color;
layout(location = 1) out vec4 sum_residual; // in alpha, squares of their weighted norms
layout(location = 2) out vec4 sum_weights;  // of squared luminances, samples, norms of residuals, uncertain luminances
layout(location = 3) out float sum_headroom;

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy), first = ivec2(tile) * TILE_SIZE, last = min(first + TILE_SIZE - 1, last_pixel());
#if FIRST_SAMPLE // all tiles have the same subpixel offset, so a tile's draw can fetch the samples of its neighbours
    first = ivec2(0);
    last = last_pixel();
#endif
    float tile_weight = fetch(tile_probabilities, at / TILE_SIZE).y / fetch(tile_probabilities, ivec2(tile)).x;
    sum_color = sum_residual = sum_weights = vec4(0.0);
    sum_headroom = 0.0;
    vec2 texel = texel_size(sample_color), filters[2 * MARGIN + 1];
    for (int k = -MARGIN; k <= MARGIN; ++k)
        filters[k + MARGIN] = vec2(filter_weight(float(k) + visibility_texel_and_offset.z),
                                   tile_weight * filter_weight(float(k) + visibility_texel_and_offset.w));
#if FILTERED
    vec4 filtered = fetch(filtered_emission, at);
    filtered.rgb /= max(filtered.a, 1e-30);
#endif
    for (int y = -MARGIN; y <= MARGIN; ++y) {
        for (int x = -MARGIN; x <= MARGIN; ++x) {
            ivec2 from = at + ivec2(x, y);
            bool is_inside = all(greaterThanEqual(from, first)) && all(lessThanEqual(from, last));
            float weight = is_inside ? filters[x + MARGIN].x * filters[y + MARGIN].y : 0.0;
            from = clamp(from, first, last);
            vec4 color = fetch(sample_color, from, texel);
#if FILTERED
            color.rgb += filtered.a > 0.0 ? filtered.rgb : fetch(sample_emission, from, texel).rgb;
#elif EMISSION
            color.rgb += fetch(sample_emission, from, texel).rgb;
#endif
            vec4 residual = HAS_RESIDUAL == 1 ? fetch(sample_residual, from, texel) : vec4(0.0);
            float corrected = luminance(color.rgb + residual.rgb), square = squared_norm(residual.rgb);
            sum_color += weight * color;
            sum_residual += vec4(weight * residual.rgb, weight * weight * square);
            sum_weights += weight * vec4(corrected * corrected, 1.0, sqrt(square), residual.a);
            sum_headroom += weight * fetch(sample_headroom, from, texel).x;
        }
    }
}
