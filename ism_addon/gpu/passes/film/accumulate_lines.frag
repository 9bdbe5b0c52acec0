// A separable wide filter: sums along rows, then along columns.
#include "maths/blackman_harris.glsl"
uniform sampler2D lines_color; // from accumulate_taken.frag; along columns, from this shader along rows
uniform sampler2D lines_residual;
uniform sampler2D lines_weights;
uniform sampler2D lines_headroom;
uniform sampler2D tile_probabilities;
uniform float filter_radius; // px
uniform int margin;  // px
layout(location = 0) out vec4 sum_color;
layout(location = 1) out vec4 sum_residual;
layout(location = 2) out vec4 sum_weights;
layout(location = 3) out float sum_headroom;

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy), last_texel = last_pixel(), to_next = COLUMNS == 1 ? ivec2(0, 1) : ivec2(1, 0);
    int first = max(-margin, -at[COLUMNS]), last = min(margin, last_texel[COLUMNS] - at[COLUMNS]);
    float tile_weight = COLUMNS == 1 ? fetch(tile_probabilities, at / TILE_SIZE).y : 1.0;
    vec2 texel = texel_size(lines_color);
    sum_color = sum_residual = sum_weights = vec4(0.0);
    sum_headroom = 0.0;
    for (int k = first; k <= last; ++k) {
        ivec2 from = at + k * to_next;
        float weight = tile_weight * blackman_harris(float(k), filter_radius);
        sum_color += weight * fetch(lines_color, from, texel);
        sum_residual += vec4(vec3(weight), weight * weight) * fetch(lines_residual, from, texel);
        sum_weights += weight * fetch(lines_weights, from, texel);
        sum_headroom += weight * fetch(lines_headroom, from, texel).x;
    }
}
