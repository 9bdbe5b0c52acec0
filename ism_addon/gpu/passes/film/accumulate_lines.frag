// A wide filter is a product of one across and one along: what was taken is added up in rows, and they in columns.
#include "maths/blackman_harris.glsl"
uniform sampler2D taken; // what accumulate_taken.frag writes, or in columns what this does in rows
uniform sampler2D taken_correction;
uniform sampler2D taken_weights;
uniform sampler2D taken_headroom;
uniform sampler2D chances;
uniform float reach; // px
uniform int margin;  // px
layout(location = 0) out vec4 sum;
layout(location = 1) out vec4 sum_correction;
layout(location = 2) out vec4 weights;
layout(location = 3) out float sum_headroom;

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy), last_taken = last_pixel(), to_next = COLUMNS == 1 ? ivec2(0, 1) : ivec2(1, 0);
    int first = max(-margin, -at[COLUMNS]), last = min(margin, last_taken[COLUMNS] - at[COLUMNS]);
    float share = COLUMNS == 1 ? fetch(chances, at / TILE_SIZE).y : 1.0;
    vec2 texel = texel_size(taken);
    sum = sum_correction = weights = vec4(0.0);
    sum_headroom = 0.0;
    for (int k = first; k <= last; ++k) {
        ivec2 from = at + k * to_next;
        float weight = share * blackman_harris(float(k), reach);
        sum += weight * fetch(taken, from, texel);
        sum_correction += vec4(vec3(weight), weight * weight) * fetch(taken_correction, from, texel);
        weights += weight * fetch(taken_weights, from, texel);
        sum_headroom += weight * fetch(taken_headroom, from, texel).x;
    }
}
