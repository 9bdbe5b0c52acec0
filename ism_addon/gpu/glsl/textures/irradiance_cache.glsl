// The irradiance by a light with a light BVH: its estimate from the root, times the ratio in the irradiance cache. Near
// the light this has a ratio for each pixel. Where no texel has one for the same surface, a better estimate replaces it.
#include "surfaces/surface.glsl"
#include "lights/light.glsl"
uniform sampler2D irradiance_ratio;
uniform int fine_width; // of the part with a texel for each pixel, beside which the coarse one is; 0: there is none

#if FINE_CACHE
uniform sampler2D prediction_surface; // for which these ratios are

// The ratio of the pixel, or of a neighbour that had the same surface; negative if there is none.
float fine_ratio(Surface surface, ivec2 at) {
    float best = 0.5, found = -1.0;
    vec2 texel = texel_size(prediction_surface);
    ivec2 last = last_pixel();
    for (int k = 0, taps = 9; k < taps; ++k) { // the pixel itself first
        ivec2 other = clamp(at + ivec2((k + 4) % 3 - 1, (k + 4) % 9 / 3 - 1), ivec2(0), last);
        vec4 other_surface = fetch(prediction_surface, other, texel);
        float weight = similarity(surface.position, surface.normal, surface.depth, other_surface);
        float ratio = fetch(irradiance_ratio, other).x;
        if (weight > best && ratio >= 0.0) {
            best = weight;
            found = ratio;
        }
        if (k == 0 && best > 0.5) taps = 1;
    }
    return found;
}
#endif

float cached_irradiance(Surface surface, Light light, ivec2 at) {
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
#if FINE_CACHE
    if (fine_width > 0) { // a light of few triangles, of which the fine part has the surroundings
        bool is_near = fetch(irradiance_ratio, at).x >= 0.0;
        if (is_near) ratio = fine_ratio(surface, at);
        similar = is_near ? ratio >= 0.0 : similar && largest < MAX_COARSE_RATIO;
        if (!similar) return emissive_mesh_accurate_irradiance(light, surface.position, surface.normal);
    }
#endif
    return ratio * estimate_light_bvh(light, surface.position, surface.normal, similar ? 1 : MAX_NODES);
}
