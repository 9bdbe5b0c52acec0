// The distance at which the ray through the texel's centre meets the disc, in metres; of parallel rays, from the plane
// through the map's origin, and not less than 0.
#include "maths/octahedron.glsl"
uniform int side;
uniform ivec2 corner;
uniform float map_radius;
flat in vec3 disc_centre;
flat in vec3 disc_normal;
flat in float disc_radius;
out float nearest;

void main() {
    vec2 square = 2.0 * (gl_FragCoord.xy - vec2(corner)) / float(side) - 1.0;
#if PARALLEL
    vec2 across = map_radius * square - disc_centre.xy;
    vec3 offset = vec3(across, -dot(disc_normal.xy, across) / disc_normal.z);
    bool hits = dot(offset, offset) <= disc_radius * disc_radius;
    float distance = max(disc_centre.z + offset.z, 0.0);
#else
    vec3 direction = hemisphere_from_square(square);
    float distance = dot(disc_normal, disc_centre) / dot(disc_normal, direction);
    vec3 offset = distance * direction - disc_centre;
    bool hits = distance > 0.0 && dot(offset, offset) <= disc_radius * disc_radius;
#endif
    nearest = hits ? distance : EMPTY;
}
