// The irradiance by a light with a light BVH: its estimate from the root, times the ratio in the irradiance cache. Near
// the light this has a ratio for each pixel. Where no texel has one for the same surface, or near the light where pixels
// differ, a better estimate replaces it.
#include "surfaces/surface.glsl"
#include "lights/light.glsl"
uniform sampler2D irradiance_ratio;
uniform int fine_width; // of the part with a texel for each pixel, beside which the coarse one is

struct CachedIrradiance { float value; vec3 color; bool is_reliable; };

// Texels whose ratios differ by more than this factor are too far from each other to interpolate between them reliably.
// Of 1.04 to 2.5, it leaves the least error in the scene lanterns of `bench error`.
const float MAX_RATIO_CHANGE = 1.1;

// With this irradiance or more, by a radiance of 1, a surface is so near the light that irradiance changes within a pixel:
// an interpolated one is not reliable. 0.3 removes most of the error of a small mesh that lights itself. The error of
// lanterns is .0190 with it, .0187 without a limit, and .0193 with 0.1.
const float NEAR_LIGHT = 0.3;

// `predicted`: the pixel that had this surface when visibility was predicted; negative if there is none.
CachedIrradiance cached_irradiance(Surface surface, Light light, ivec2 at, ivec2 predicted) {
    vec3 color_sum = vec3(0.0);
    float sum = 0.0, weights = 0.0, smallest = 1e30, largest = 0.0;
    vec2 offset = vec2(at % CACHE_SPACING) / float(CACHE_SPACING), texel = texel_size(position);
    for (int k = 0; k < 4; ++k) { // as upsample_tap, but there are texels beyond the last pixel
        ivec2 step = ivec2(k & 1, k >> 1), other = at / CACHE_SPACING + step;
        vec2 bilinear = mix(1.0 - offset, offset, vec2(step));
        float weight = bilinear.x * bilinear.y * similarity(surface, min(CACHE_SPACING * other, last_pixel()), texel);
        vec4 texel_at = fetch(irradiance_ratio, ivec2(fine_width, 0) + other);
        float ratio = texel_at.x;
        if (ratio < 0.0) weight = 0.0; // NO_RATIO
        sum += weight * ratio;
        color_sum += weight * ratio * texel_at.yzw;
        weights += weight;
        smallest = min(smallest, weight > 0.0 ? ratio : 1e30);
        largest = max(largest, weight > 0.0 ? ratio : 0.0);
    }
    bool similar = weights > 1e-3, is_reliable = weights > 0.5 && largest <= MAX_RATIO_CHANGE * smallest;
    float ratio = similar ? sum / weights : 1.0;
    vec3 color = color_sum / max(sum, 1e-30);
#if CACHED == FINE_CACHE // a light of few triangles, of which the fine part has the surroundings
    if (fetch(irradiance_ratio, at).x >= 0.0) {
        vec4 texel_at = fetch(irradiance_ratio, max(predicted, 0));
        ratio = predicted.x < 0 ? -1.0 : texel_at.x;
        color = texel_at.yzw;
        smallest = largest = ratio;
        for (int k = 0; k < 4; ++k) { // what is smaller than a pixel and near the light changes from pixel to pixel
            ivec2 step = k < 2 ? ivec2(2 * k - 1, 0) : ivec2(0, 2 * k - 5);
            float next = fetch(irradiance_ratio, clamp(max(predicted, 0) + step, ivec2(0), last_pixel())).x;
            smallest = min(smallest, next < 0.0 ? smallest : next);
            largest = max(largest, next);
        }
        similar = is_reliable = ratio >= 0.0 && largest <= MAX_RATIO_CHANGE * smallest;
    } else {
        similar = similar && largest < MAX_COARSE_RATIO;
    }
    if (!similar) {
        vec4 accurate = emissive_mesh_accurate_irradiance(light, surface.position, surface.normal);
        return CachedIrradiance(accurate.x, mean_color(accurate), true);
    }
#endif
    vec4 estimate = estimate_light_bvh(light, surface.position, surface.normal, similar ? CACHED_NODES : MAX_NODES);
#if MESH_COLORS
    if (!similar) color = mean_color(estimate);
#else
    color = vec3(1.0);
#endif
    float irradiance = ratio * estimate.x;
    return CachedIrradiance(irradiance, color, is_reliable && irradiance < NEAR_LIGHT);
}
