// Where the texel's direction meets the disc: its plane's distance, not its centre's. m
#include "lib/octahedron.glsl"
uniform int side;
uniform ivec2 corner;
flat in vec3 centre;
flat in vec3 normal;
flat in float radius;
out float nearest;

void main() {
    vec2 square = 2.0 * (gl_FragCoord.xy - vec2(corner)) / float(side) - 1.0;
    vec3 direction = hemisphere_from_square(square);
    float along = dot(normal, centre) / dot(normal, direction);
    vec3 off = along * direction - centre;
    nearest = along > 0.0 && dot(off, off) <= radius * radius ? along : EMPTY;
}
