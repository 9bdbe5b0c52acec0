// One ray from each block.
#include "lib/look.glsl"
uniform int light_index;
out vec2 seen; // rays that arrived, and rays

void main() { seen = look(light_index, ivec2(gl_FragCoord.xy), BLOCK); }
