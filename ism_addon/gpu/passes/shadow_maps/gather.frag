// Radiance towards the camera: a light's unshadowed one times the part of its virtual lights that see the pixel, weighted by
// what they send.
#include "surfaces/bsdf.glsl"
#include "surfaces/receiver_linking.glsl"

uniform usamplerBuffer lights;
uniform usamplerBuffer virtual_light_ranges;
uniform usamplerBuffer virtual_lights;
uniform sampler2D shadow_maps;
uniform int light_count; // of those that contribute
uniform ivec2 batch;     // first virtual light, number of virtual lights
uniform int side;
uniform int columns;
uniform bool shadows;
uniform float bias;
out vec4 direct_prediction;

// 1 where the virtual light whose map is number `index` sees the receiver: v from the virtual light, n its plane's normal,
// both in the light's space.
float visibility(vec2 rotation, int index, vec3 v, vec3 n) {
    mat2 map_from_light = mat2(rotation.x, -rotation.y, rotation.y, rotation.x);
    float texel_angle = 2.5 / float(side); // a hemisphere's 2 pi steradians, shared by the map's texels
    v += n * (bias * texel_angle * length(v));
    vec2 square = square_from_hemisphere(vec3(map_from_light * v.xy, max(v.z, 0.0)));
    ivec2 texel = clamp(ivec2((0.5 * square + 0.5) * float(side)), ivec2(0), ivec2(side - 1));
    vec3 centre = hemisphere_from_square((vec2(texel) + 0.5) * (2.0 / float(side)) - 1.0);
    float plane = dot(n, v) / dot(vec3(map_from_light * n.xy, n.z), centre);
    float distance = length(v);
    // A plane seen edge-on reaches from here to nowhere within a texel: there its own distance must do.
    float receiver = plane > 0.5 * distance && plane < 2.0 * distance ? plane : distance;
    int row = int((float(index) + 0.5) / float(columns)); // integer division is slow on many machines
    ivec2 corner = ivec2(index - row * columns, row) * side;
    return fetch(shadow_maps, corner + texel).x >= receiver ? 1.0 : 0.0;
}

vec3 shadowed_radiance(Surface surface, Light light, VirtualLightRange points) {
    bool masked = shadows && light.casts_shadow != 0;
    vec3 unshadowed = bsdf_unshadowed(surface, light);
    if (!masked) return batch.x == 0 ? unshadowed : vec3(0.0);
    mat3 light_from_anchor = transpose(mat3(light.tangent, cross(light.normal, light.tangent), light.normal));
    // Where no point of its own can light a receiver, those closest to where its light comes from say what is hidden.
    vec3 from = light_from_anchor * (light_sample(light, surface.position, surface.normal, vec2(0.5)).point - light.position);
    vec3 p = light_from_anchor * (surface.position - light.position), n = light_from_anchor * surface.normal;
    vec3 geometric_normal = light_from_anchor * surface.geometric_normal;
    float sent = 0.0, arrived = 0.0, close = 0.0, arrived_close = 0.0;
    int last = unshadowed == vec3(0.0) ? 0 : points.first + points.count;
    for (int k = points.first; k < last; ++k) {
        VirtualLight point = fetch_VirtualLight(virtual_lights, k);
        vec3 v = p - point.offset;
        float weight = light_virtual_weight(light, v, n);
        vec3 off = point.offset - from;
        float closeness = 1.0 / max(dot(off, off) * dot(off, off), 1e-30);
        sent += weight;
        close += closeness;
        int index = k - batch.x;
        if (index < 0 || index >= batch.y) continue;
        float unoccluded = visibility(point.rotation, index, v, geometric_normal);
        arrived += weight * unoccluded;
        arrived_close += closeness * unoccluded;
    }
    if (close == 0.0) return vec3(0.0);
    return unshadowed * (sent > 0.0 ? arrived / sent : arrived_close / close);
}

void main() {
    direct_prediction = vec4(0.0);
    Surface surface = surface_at(ivec2(gl_FragCoord.xy));
    if (!surface.exists) return;
    for (int k = 0; k < light_count; ++k) {
        VirtualLightRange points = fetch_VirtualLightRange(virtual_light_ranges, k);
        Light light = fetch_Light(lights, points.light);
        if (!is_lit_by(surface, light)) continue;
        direct_prediction.rgb += shadowed_radiance(surface, light, points);
    }
}
