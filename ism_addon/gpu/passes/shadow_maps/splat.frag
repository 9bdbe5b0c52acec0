// The distance at which the ray through the texel's centre meets the disc, in metres.
#include "maths/octahedron.glsl"
uniform int side;
uniform ivec2 corner;
flat in vec3 disc_centre;
flat in vec3 disc_normal;
flat in float disc_radius;
out float nearest;

void main() {
    vec2 square = 2.0 * (gl_FragCoord.xy - vec2(corner)) / float(side) - 1.0;
    vec3 direction = hemisphere_from_square(square);
    float distance = dot(disc_normal, disc_centre) / dot(disc_normal, direction);
    vec3 offset = distance * direction - disc_centre;
    nearest = distance > 0.0 && dot(offset, offset) <= disc_radius * disc_radius ? distance : EMPTY;
}
