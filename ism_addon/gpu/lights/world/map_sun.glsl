// The sun in a map: it lights surfaces as an even disc, and is sampled by its texels, see gpu/environment/map_sun.py.
#include "../lights/sun.glsl"
#include "maths/equirectangular.glsl"

struct MapSunPatch { ivec2 corner; ivec2 size; }; // texels of the map

MapSunPatch map_sun_patch() {
    ivec4 texel = ivec4(texelFetch(scene_records, environment_sun));
    return MapSunPatch(texel.xy, texel.zw);
}

// Of the texel at an index: its radiance, its probability, and the sum of this and those before.
vec3 map_sun_texel(int index) { return uintBitsToFloat(texelFetch(scene_records, environment_sun + 1 + index)).xyz; }

// Radiance, and density where that of a texel of the map is 1. `at`: texels from the patch's corner.
vec2 map_sun_interpolated(MapSunPatch area, vec2 at) {
    vec2 low = floor(at - 0.5), part = at - 0.5 - low, sum = vec2(0.0);
    for (int k = 0; k < 4; ++k) {
        ivec2 corner = ivec2(k & 1, k >> 1), texel = ivec2(low) + corner;
        if (any(lessThan(texel, ivec2(0))) || any(greaterThanEqual(texel, area.size))) continue;
        vec2 weight = mix(1.0 - part, part, vec2(corner));
        sum += weight.x * weight.y * map_sun_texel(texel.y * area.size.x + texel.x).xy;
    }
    return sum;
}

// The same, with the density by solid angle.
vec2 map_sun_in_direction(vec3 wi) {
    MapSunPatch area = map_sun_patch();
    wi = environment_rotation * wi;
    vec2 at = map_from_direction(wi) * vec2(environment_size) - vec2(area.corner);
    at.x -= float(environment_size.x) * floor((at.x + 0.5) / float(environment_size.x)); // across the map's edge
    vec2 texel = vec2(2.0 * HALF_TURN, HALF_TURN) / vec2(environment_size);
    float solid_angle = max(texel.x * texel.y * sqrt(max(1.0 - wi.z * wi.z, 0.0)), 1e-37);
    return map_sun_interpolated(area, at) / vec2(1.0, solid_angle);
}

float map_sun_irradiance(Light light, vec3 p, vec3 n) { return sun_irradiance(light, p, n); }

// A point of a tent from -1 to 1, from one of 0 to 1.
vec2 tent_sample(vec2 uv) { return mix(sqrt(2.0 * uv) - 1.0, 1.0 - sqrt(2.0 - 2.0 * uv), step(0.5, uv)); }

LightSample map_sun_sample(Light light, vec3 p, vec3 n, vec2 uv) {
    MapSunPatch area = map_sun_patch();
    int first = 0, last = area.size.x * area.size.y - 1;
    while (first < last) {
        int middle = (first + last) / 2;
        if (map_sun_texel(middle).z > uv.x) last = middle; else first = middle + 1;
    }
    vec3 texel = map_sun_texel(first);
    uv.x = clamp(1.0 - (texel.z - uv.x) / max(texel.y, 1e-30), 0.0, 1.0);
    vec2 at = vec2(first % area.size.x, first / area.size.x) + 0.5 + tent_sample(uv);
    vec3 wi = direction_from_map((vec2(area.corner) + at) / vec2(environment_size)) * environment_rotation;
    vec2 found = map_sun_in_direction(wi);
    return LightSample(sun_point(p, wi), wi, found.x, max(found.y, 1e-37), -1);
}

float map_sun_pdf(Light light, vec3 p, vec3 n, vec3 wi) { return map_sun_in_direction(wi).y; }

float map_sun_emitted(Light light, vec3 p, vec3 wi) { return map_sun_in_direction(wi).x; }

float map_sun_virtual_weight(Light light, vec3 v, vec3 n, vec3 axis) { return sun_virtual_weight(light, v, n, axis); }

vec3 map_sun_centre(Light light, vec3 p, vec3 to) { return sun_centre(light, p, to); }

float map_sun_hit_distance(Light light, vec3 p, vec3 wi) { return sun_hit_distance(light, p, wi); }
