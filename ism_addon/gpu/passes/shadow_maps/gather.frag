// Radiance towards the camera: each light's unshadowed radiance times the fraction of its virtual lights, weighted by
// their irradiance, that are visible from the pixel.
#include "surfaces/bsdf.glsl"
#include "surfaces/receiver_linking.glsl"
#if CACHED
#include "textures/irradiance_cache.glsl"
#endif

uniform usamplerBuffer virtual_light_ranges;
uniform usamplerBuffer virtual_lights;
uniform sampler2D shadow_maps;
uniform int first_light; // of those that contribute
uniform int light_count;
uniform ivec2 batch;     // first virtual light, number of virtual lights
uniform int side;
uniform int columns;
uniform bool shadows;
uniform float bias;
out vec4 direct_prediction;

// The depth in the map of this index in the atlas, at a texel.
float occluder_depth(int index, ivec2 texel) {
    int row = int((float(index) + 0.5) / float(columns)); // integer division is slow on many machines
    return fetch(shadow_maps, ivec2(index - row * columns, row) * side + texel).x;
}

#if PARALLEL
// As `visibility`, in a map of parallel light; v goes from the map's origin.
float parallel_visibility(VirtualLight virtual_light, int index, vec3 v, vec3 n) {
    vec3 x = virtual_light.x_axis, z = virtual_light.axis;
    mat3 anchor_from_map = mat3(x, cross(z, x), z);
    float radius = virtual_light.map_radius;
    v += n * (bias * 2.0 * radius / float(side));
    vec3 in_map = v * anchor_from_map, map_n = n * anchor_from_map;
    vec2 square = in_map.xy / radius;
    ivec2 texel = clamp(ivec2((0.5 * square + 0.5) * float(side)), ivec2(0), ivec2(side - 1));
    vec2 across = radius * ((vec2(texel) + 0.5) * (2.0 / float(side)) - 1.0) - in_map.xy;
    // At grazing angles the plane's depth varies without bound within a texel: the receiver's own is used instead.
    float slope = -dot(map_n.xy, across) / map_n.z;
    float receiver = in_map.z + (abs(slope) < 0.25 * radius ? slope : 0.0);
    return occluder_depth(index, texel) >= receiver ? 1.0 : 0.0;
}
#endif

// 1 if the virtual light whose map has this index in the atlas is visible from the receiver, else 0. v goes from the
// virtual light to the receiver, whose geometric normal is n.
float visibility(VirtualLight virtual_light, int index, vec3 v, vec3 n) {
#if PARALLEL
    if (virtual_light.map_radius > 0.0) return parallel_visibility(virtual_light, index, v, n);
#endif
    vec3 x = virtual_light.x_axis, z = virtual_light.axis;
    mat3 anchor_from_map = mat3(x, cross(z, x), z);
    float texel_angle = 2.5 / float(side); // a hemisphere's 2 pi steradians, shared by the map's texels
    v += n * (bias * texel_angle * length(v));
    vec3 in_map = v * anchor_from_map;
    vec2 square = square_from_hemisphere(vec3(in_map.xy, max(in_map.z, 0.0)));
    ivec2 texel = clamp(ivec2((0.5 * square + 0.5) * float(side)), ivec2(0), ivec2(side - 1));
    vec3 centre = hemisphere_from_square((vec2(texel) + 0.5) * (2.0 / float(side)) - 1.0);
    float plane = dot(n, v) / dot(n, anchor_from_map * centre);
    float distance = length(v);
    // At grazing angles the plane's depth varies without bound within a texel: the receiver's distance is used instead.
    float receiver = plane > 0.5 * distance && plane < 2.0 * distance ? plane : distance;
    return occluder_depth(index, texel) >= receiver ? 1.0 : 0.0;
}

vec3 shadowed_radiance(Surface surface, Light light, VirtualLightRange range) {
    bool is_shadowed = shadows && light.casts_shadow != 0;
#if CACHED
    CachedIrradiance cached = cached_irradiance(surface, light, ivec2(gl_FragCoord.xy), ivec2(-1));
    float irradiance = cached.value;
    vec3 color = cached.color;
#else
    float irradiance = light_irradiance(light, surface.position, surface.normal);
    vec3 color = light_mean_color(light, surface.position, surface.normal);
#endif
    vec3 unshadowed = unshadowed_diffuse(surface, light, irradiance, color);
#if GLOSS
    vec3 wo = direction_to_camera(surface.position);
    unshadowed += predict_lobes(surface, lobes_at(ivec2(gl_FragCoord.xy), surface, wo), light, irradiance, color).radiance;
#endif
    if (!is_shadowed) return batch.x == 0 ? unshadowed : vec3(0.0);
    // If no virtual light is above the receiver's horizon, those closest to the light's part above it are used.
    LightSample middle_sample = light_sample(light, surface.position, surface.normal, vec2(0.5));
    vec3 middle = middle_sample.point - light.position;
    vec3 p = surface.position - light.position;
    float sum = 0.0, visible_sum = 0.0, close_sum = 0.0, visible_close_sum = 0.0;
    int last = unshadowed == vec3(0.0) ? 0 : range.first + range.count;
    for (int k = range.first; k < last; ++k) {
        VirtualLight virtual_light = fetch_VirtualLight(virtual_lights, k);
        vec3 v = p - virtual_light.offset;
        float weight = light_virtual_weight(light, v, surface.normal, virtual_light.axis);
        vec3 from_middle = virtual_light.offset - middle;
#if PARALLEL
        if (virtual_light.map_radius > 0.0) from_middle = virtual_light.axis + middle_sample.wi;
#endif
        float closeness = 1.0 / max(dot(from_middle, from_middle) * dot(from_middle, from_middle), 1e-30);
        sum += weight;
        close_sum += closeness;
        int index = k - batch.x;
        if (index < 0 || index >= batch.y) continue;
        float unoccluded = visibility(virtual_light, index, v, surface.geometric_normal);
        visible_sum += weight * unoccluded;
        visible_close_sum += closeness * unoccluded;
    }
    if (close_sum == 0.0) return vec3(0.0);
    return unshadowed * (sum > 0.0 ? visible_sum / sum : visible_close_sum / close_sum);
}

void main() {
    direct_prediction = vec4(0.0);
    Surface surface = surface_at(ivec2(gl_FragCoord.xy));
    if (!surface.exists) return;
    for (int k = first_light; k < first_light + light_count; ++k) {
        VirtualLightRange range = fetch_VirtualLightRange(virtual_light_ranges, k);
        Light light = fetch_Light(scene_records, lights + range.light);
        if (!is_lit_by(surface, light)) continue;
        direct_prediction.rgb += shadowed_radiance(surface, light, range);
    }
}
