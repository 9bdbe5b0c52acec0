// One ray from each tile, or from some, to each of several lights: a strip of the target for each.
#include "trace/probe.glsl"
uniform usampler2D probed_lights; // index of each light, and light_uv
uniform int strip_rows;
uniform int spacing; // px
out vec2 rays; // that arrived, and all

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    uvec3 light = fetch(probed_lights, ivec2(at.y / strip_rows, 0)).xyz;
    rays = probe(int(light.x), light.yz, ivec2(at.x, at.y % strip_rows), spacing);
}
