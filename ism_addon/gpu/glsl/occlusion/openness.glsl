// The open part of a pixel's surroundings, as it is predicted, and by the pixel's own ray if there is one.
uniform sampler2D ambient_occlusion; // of rays both; else at half resolution
#if TRACED_OCCLUSION
vec2 openness_at(ivec2 at, Surface surface) { return fetch(ambient_occlusion, at).xy; }
#else
#include "textures/bilateral_upsample.glsl"

vec2 openness_at(ivec2 at, Surface surface) {
    float sum = 0.0, weights = 0.0;
    for (int k = 0; k < 4; ++k) {
        UpsampleTap other = upsample_tap(k, at, surface, 2);
        sum += other.weight * fetch(ambient_occlusion, other.at).x;
        weights += other.weight;
    }
    return vec2(sum / weights);
}
#endif
