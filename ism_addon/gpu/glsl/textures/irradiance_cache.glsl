// The irradiance by a light with a light BVH: its estimate from the root, times the ratio in the irradiance cache. Near
// the light this has a ratio for each pixel. Where no texel has one for the same surface, a better estimate replaces it.
#include "surfaces/surface.glsl"
#include "lights/light.glsl"
uniform sampler2D irradiance_ratio;
uniform int fine_width; // of the part with a texel for each pixel, beside which the coarse one is

// `predicted`: the pixel that had this surface when visibility was predicted; negative if there is none.
float cached_irradiance(Surface surface, Light light, ivec2 at, ivec2 predicted) {
    float sum = 0.0, weights = 0.0, largest = 0.0;
    vec2 offset = vec2(at % CACHE_SPACING) / float(CACHE_SPACING), texel = texel_size(position);
    for (int k = 0; k < 4; ++k) { // as upsample_tap, but there are texels beyond the last pixel
        ivec2 step = ivec2(k & 1, k >> 1), other = at / CACHE_SPACING + step;
        vec2 bilinear = mix(1.0 - offset, offset, vec2(step));
        float weight = bilinear.x * bilinear.y * similarity(surface, min(CACHE_SPACING * other, last_pixel()), texel);
        float ratio = fetch(irradiance_ratio, ivec2(fine_width, 0) + other).x;
        if (ratio < 0.0) weight = 0.0; // NO_RATIO
        sum += weight * ratio;
        weights += weight;
        largest = max(largest, weight > 0.0 ? ratio : 0.0);
    }
    bool similar = weights > 1e-3;
    float ratio = similar ? sum / weights : 1.0;
#if CACHED == FINE_CACHE // a light of few triangles, of which the fine part has the surroundings
    if (fetch(irradiance_ratio, at).x >= 0.0) {
        ratio = predicted.x < 0 ? -1.0 : fetch(irradiance_ratio, predicted).x;
        similar = ratio >= 0.0;
    } else {
        similar = similar && largest < MAX_COARSE_RATIO;
    }
    if (!similar) return emissive_mesh_accurate_irradiance(light, surface.position, surface.normal);
#endif
    return ratio * estimate_light_bvh(light, surface.position, surface.normal, similar ? 1 : MAX_NODES);
}
