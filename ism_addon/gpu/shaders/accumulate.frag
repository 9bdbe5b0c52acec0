// One more sample; blending adds it.
#include "lib/luminance.glsl"
uniform sampler2D color;
uniform sampler2D correction;
uniform bool corrected;
layout(location = 0) out vec4 sum;
layout(location = 1) out vec4 sum_correction;
layout(location = 2) out float squares;

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    sum = texelFetch(color, at, 0);
    sum_correction = corrected ? texelFetch(correction, at, 0) : vec4(0.0);
    float bright = luminance(sum.rgb + sum_correction.rgb);
    squares = bright * bright;
}
