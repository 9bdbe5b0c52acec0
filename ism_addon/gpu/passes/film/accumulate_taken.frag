// The samples of one tile for a wide filter, weighted for pixels of a tile with probability 1: see accumulate.frag.
#include "maths/luminance.glsl"
uniform sampler2D sample_color;
uniform sampler2D sample_residual;
#if EMISSION
uniform sampler2D sample_emission;
#endif
uniform sampler2D sample_headroom;
uniform sampler2D tile_probabilities;
flat in vec2 tile;
layout(location = 0) out vec4 sum_color;
layout(location = 1) out vec4 sum_residual;
layout(location = 2) out vec4 sum_weights;
layout(location = 3) out float sum_headroom;

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    float weight = 1.0 / fetch(tile_probabilities, ivec2(tile)).x;
    vec4 color = fetch(sample_color, at), residual = HAS_RESIDUAL == 1 ? fetch(sample_residual, at) : vec4(0.0);
#if EMISSION
    color.rgb += fetch(sample_emission, at).rgb;
#endif
    float corrected = luminance(color.rgb + residual.rgb), square = squared_norm(residual.rgb);
    sum_color = weight * color;
    sum_residual = vec4(weight * residual.rgb, weight * weight * square);
    sum_weights = weight * vec4(corrected * corrected, 1.0, sqrt(square), residual.a);
    sum_headroom = weight * fetch(sample_headroom, at).x;
}
