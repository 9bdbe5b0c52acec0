// Corrections as their neighbours on the same surface have them, and how both stand to their noise.
#include "lib/luminance.glsl"
#include "lib/surface.glsl"
uniform sampler2D sum_correction; // in alpha, the squares of their weighted luminances
uniform sampler2D weights;
layout(location = 0) out vec4 near;      // mean of the corrections
layout(location = 1) out vec4 stand_out; // squared luminance and variance of the own one's difference, and of the mean

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy), last = textureSize(sum_correction, 0) - 1;
    Surface here = surface_at(at);
    float all = 0.0, squares = 0.0, own = max(texelFetch(weights, at, 0).z, 1e-30);
    near = vec4(0.0);
    for (int k = 0; k < 9; ++k) {
        ivec2 other = clamp(at + ivec2(k % 3 - 1, k / 3 - 1), ivec2(0), last);
        float like = k == 4 ? 1.0 : alike(here, other), weight = max(texelFetch(weights, other, 0).z, 1e-30);
        near += like * texelFetch(sum_correction, other, 0);
        all += like * weight;
        squares += like * like * weight * weight;
    }
    near /= all;
    vec4 mine = texelFetch(sum_correction, at, 0) / own;
    float difference = luminance(mine.rgb - near.rgb), mean = luminance(near.rgb), variance = mine.a / own;
    stand_out = vec4(difference * difference, variance * (1.0 - own / all),
                     mean * mean, variance * squares / (all * all));
}
