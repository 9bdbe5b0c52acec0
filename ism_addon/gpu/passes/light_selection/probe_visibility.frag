// One ray from every fourth pixel.
#include "trace/probe.glsl"
uniform int light_index;
uniform uvec2 light_uv;
out vec2 rays; // that arrived, and all

void main() { rays = probe(light_index, light_uv, ivec2(gl_FragCoord.xy), PROBE_SPACING); }
