// The mean depth of the nearest surface in four finer texels, and the fraction of them that it covers.
#include "textures/pull_push_level.glsl"
out vec2 texel;

void main() {
    ivec2 at = 2 * ivec2(gl_FragCoord.xy);
    vec2 four[4];
    float nearest = EMPTY;
    for (int k = 0; k < 4; ++k) {
        four[k] = fine_texel(at + ivec2(k & 1, k >> 1));
        if (four[k].y > 0.0) nearest = min(nearest, four[k].x);
    }
    float depth = 0.0, coverage = 0.0;
    for (int k = 0; k < 4; ++k) {
        if (four[k].y > 0.0 && four[k].x <= nearest * (1.0 + threshold)) {
            depth += four[k].x * four[k].y;
            coverage += four[k].y;
        }
    }
    texel = coverage > 0.0 ? vec2(depth / coverage, 0.25 * coverage) : vec2(EMPTY, 0.0);
}
