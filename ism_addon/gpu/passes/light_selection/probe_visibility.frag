// One ray from every fourth pixel.
#include "trace/probe.glsl"
uniform int light_index;
uniform uvec2 place;
out vec2 seen; // rays that arrived, and rays

void main() { seen = look(light_index, place, ivec2(gl_FragCoord.xy), PROBE_SPACING); }
