// The irradiance by a light with a light BVH: its estimate from the root, times the ratio in the irradiance cache. Where
// no texel of the cache has a ratio for the same surface, a better estimate replaces it.
#include "surfaces/surface.glsl"
#include "lights/light.glsl"
uniform sampler2D irradiance_ratio;

float cached_irradiance(Surface surface, Light light, ivec2 at) {
    float sum = 0.0, weights = 0.0;
    vec2 offset = vec2(at % CACHE_SPACING) / float(CACHE_SPACING), texel = texel_size(position);
    for (int k = 0; k < 4; ++k) { // as upsample_tap, but there are texels beyond the last pixel
        ivec2 step = ivec2(k & 1, k >> 1), other = at / CACHE_SPACING + step;
        vec2 bilinear = mix(1.0 - offset, offset, vec2(step));
        float weight = bilinear.x * bilinear.y * similarity(surface, min(CACHE_SPACING * other, last_pixel()), texel);
        float ratio = fetch(irradiance_ratio, other).x;
        if (ratio < 0.0) weight = 0.0; // NO_RATIO
        sum += weight * ratio;
        weights += weight;
    }
    bool similar = weights > 1e-3;
    float estimate = estimate_light_bvh(light, surface.position, surface.normal, similar ? 1 : MAX_NODES);
    return similar ? estimate * sum / weights : estimate;
}
