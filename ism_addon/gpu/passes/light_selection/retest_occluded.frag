// One ray from every fourth pixel of a tile, to the light that the tile is drawn for.
#include "trace/probe.glsl"
uniform uvec2 light_uv;
flat in float tile_light;
out vec4 sums; // over rays that arrived, three that identify the light if only one hit the pixel: of the light's number,
               // counted from one, of its square, and of ones

void main() {
    float number = tile_light + 1.0;
    sums = floor(probe(int(tile_light + 0.5), light_uv, ivec2(gl_FragCoord.xy), PROBE_SPACING).x)
         * vec4(number, number * number, 1.0, 0.0);
}
