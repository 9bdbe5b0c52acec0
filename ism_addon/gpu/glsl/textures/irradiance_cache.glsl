// The ratio of a light's irradiance to its estimate, from the irradiance cache.
#include "textures/bilateral_upsample.glsl"
uniform sampler2D irradiance_ratio;

float cached_irradiance_ratio(Surface surface, ivec2 at) {
    float sum = 0.0, weights = 0.0;
    for (int k = 0; k < 4; ++k) {
        UpsampleTap other = upsample_tap(k, at, surface, CACHE_SPACING);
        sum += other.weight * fetch(irradiance_ratio, other.at).x;
        weights += other.weight;
    }
    return sum / weights;
}
