// The samples of one block for a wide filter, as they count for a pixel of chance 1: see accumulate.frag.
#include "maths/luminance.glsl"
uniform sampler2D color;
uniform sampler2D correction;
uniform sampler2D headroom;
uniform sampler2D chances;
flat in vec2 own_block;
layout(location = 0) out vec4 sum;
layout(location = 1) out vec4 sum_correction;
layout(location = 2) out vec4 weights;
layout(location = 3) out float sum_headroom;

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    float weight = 1.0 / fetch(chances, ivec2(own_block)).x;
    vec4 sampled = fetch(color, at), wrong = CORRECTED == 1 ? fetch(correction, at) : vec4(0.0);
    float bright = luminance(sampled.rgb + wrong.rgb), amount = weight * luminance(wrong.rgb);
    sum = weight * sampled;
    sum_correction = vec4(weight * wrong.rgb, amount * amount);
    weights = weight * vec4(bright * bright, 1.0, abs(luminance(wrong.rgb)), wrong.a);
    sum_headroom = weight * fetch(headroom, at).x;
}
