// The radiance of the world in the directions of an equirectangular map's texels: the mean of POINTS * POINTS points each.
#include "surfaces/node_graph.glsl"
#include "maths/equirectangular.glsl"
uniform ivec2 map_size;
uniform int first_constant;
out vec4 radiance;

vec3 direction_at(vec2 texel) { return direction_from_map(texel / vec2(map_size)); }

void main() {
    vec3 sum = vec3(0.0);
    for (int k = 0; k < POINTS * POINTS; ++k) {
        vec2 texel = floor(gl_FragCoord.xy) + (vec2(k % POINTS, k / POINTS) + 0.5) / float(POINTS);
        vec3 d = direction_at(texel);
        Shift none = Shift(vec3(0.0), vec3(0.0));
        Shift dx = Shift(direction_at(texel + vec2(1.0 / float(POINTS), 0.0)) - d, vec3(0.0));
        Shift dy = Shift(direction_at(texel + vec2(0.0, 1.0 / float(POINTS))) - d, vec3(0.0));
        ShadingPoint at = ShadingPoint(d, vec3(0.0), -d, -d, -d, false, 0, 0);
        sum += finite(evaluate_graph(at, Differentials(dx, dy, none, none), first_constant).emission, MAX_RADIANCE);
    }
    radiance = vec4(sum / float(POINTS * POINTS), 0.0);
}
