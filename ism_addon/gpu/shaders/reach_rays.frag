// One ray from each block, or from some.
#include "lib/look.glsl"
uniform int light_index;
uniform int apart; // px
out vec2 seen; // rays that arrived, and rays

void main() { seen = look(light_index, ivec2(gl_FragCoord.xy), apart); }
