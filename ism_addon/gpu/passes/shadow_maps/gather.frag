// Irradiance: a light's exact value times the part of its light points that see the pixel, weighted by what they send.
#include "surfaces/light_linking.glsl"
#include "maths/octahedron.glsl"
#include "lights/light_sample.glsl"

uniform sampler2D position;
uniform sampler2D normals;
uniform usampler2D triangles;
uniform samplerBuffer memberships;
uniform samplerBuffer lights;
uniform samplerBuffer points_of_lights;
uniform samplerBuffer virtual_lights;
uniform sampler2D maps;
uniform int light_count; // of those that count
uniform ivec2 batch; // first light point, number of light points
uniform int side;
uniform int columns;
uniform bool shadows;
uniform float bias;
out vec4 irradiance;

// 1 where the light point whose map is number `index` sees the receiver: v from the light point, n its plane's normal,
// both in the light's space.
float visibility(vec2 turn, int index, vec3 v, vec3 n) {
    mat2 map_from_light = mat2(turn.x, -turn.y, turn.y, turn.x);
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
    return fetch(maps, corner + texel).x >= receiver ? 1.0 : 0.0;
}

vec3 light_irradiance(Light light, PointsOfLight points, vec3 p, vec3 n, vec3 facet) {
    bool masked = shadows && light.casts_shadow != 0;
    vec3 full = light.radiance * unshadowed_irradiance(light, p, n);
    if (!masked) return batch.x == 0 ? full : vec3(0.0);
    mat3 light_from_anchor = transpose(mat3(light.tangent, cross(light.normal, light.tangent), light.normal));
    // Where no point of its own can light a receiver, those closest to where its light comes from say what is hidden.
    vec3 from = light_from_anchor * (sample_light(light, p, n, vec2(0.5)).point - light.position);
    p = light_from_anchor * (p - light.position);
    n = light_from_anchor * n;
    facet = light_from_anchor * facet;
    float sent = 0.0, arrived = 0.0, close = 0.0, arrived_close = 0.0;
    int last = full == vec3(0.0) ? 0 : points.first + points.count;
    for (int k = points.first; k < last; ++k) {
        LightPoint point = fetch_LightPoint(virtual_lights, k);
        vec3 v = vec3(p.xy - point.place, p.z);
        float square = dot(v, v);
        float weight = max(-dot(n, v), 0.0) * p.z / max(square * square, 1e-30);
        weight *= spread(light, p.z, length(v.xy));
        vec2 off = point.place - from.xy;
        float closeness = 1.0 / max(dot(off, off) * dot(off, off), 1e-30);
        sent += weight;
        close += closeness;
        int index = k - batch.x;
        if (index < 0 || index >= batch.y) continue;
        float seen = visibility(point.turn, index, v, facet);
        arrived += weight * seen;
        arrived_close += closeness * seen;
    }
    if (close == 0.0) return vec3(0.0);
    return full * (sent > 0.0 ? arrived / sent : arrived_close / close);
}

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    vec4 p = fetch(position, at);
    irradiance = vec4(0.0);
    if (p.w == 0.0) return;
    vec4 octahedra = fetch(normals, at);
    vec3 n = direction_from_octahedron(octahedra.xy), facet = direction_from_octahedron(octahedra.zw);
    int groups = fetch_Membership(memberships, int(fetch(triangles, at).y)).groups;
    for (int k = 0; k < light_count; ++k) {
        PointsOfLight points = fetch_PointsOfLight(points_of_lights, k);
        Light light = fetch_Light(lights, points.light);
        if (light.receivers >= 0 && !linked(groups, light.receivers)) continue;
        irradiance.rgb += light_irradiance(light, points, p.xyz, n, facet);
    }
}
