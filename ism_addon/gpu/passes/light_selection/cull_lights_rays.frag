// One ray from each block, or from some, to each of several lights: a strip of the target for each.
#include "trace/probe.glsl"
uniform usampler2D asked; // the number of each light, and the place on it
uniform int rows;        // of a strip
uniform int apart;       // px
out vec2 seen; // rays that arrived, and rays

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    uvec3 light = fetch(asked, ivec2(at.y / rows, 0)).xyz;
    seen = look(int(light.x), light.yz, ivec2(at.x, at.y % rows), apart);
}
