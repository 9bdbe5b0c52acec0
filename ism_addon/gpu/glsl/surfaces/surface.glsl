// How far two pixels show one surface.
#include "surfaces/similarity.glsl"
uniform sampler2D position; // in alpha, the normal, packed
uniform sampler2D normals;
uniform sampler2D depth;

struct Surface { vec3 position; vec3 normal; float depth; bool seen; };

Surface surface_at(ivec2 pixel) {
    vec4 p = fetch(position, pixel);
    return Surface(p.xyz, direction_from_octahedron(fetch(normals, pixel).xy), fetch(depth, pixel).x, p.w > 0.0);
}

float alike(Surface a, ivec2 pixel, vec2 texel) {
    return alike(a.position, a.normal, a.depth, fetch(position, pixel, texel));
}
