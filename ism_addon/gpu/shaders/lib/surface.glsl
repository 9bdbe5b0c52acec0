// How far two pixels show one surface.
#include "lib/octahedron.glsl"
#include "lib/packed_normal.glsl"
uniform sampler2D position; // in alpha, the normal, packed
uniform sampler2D normals;
uniform sampler2D depth;

struct Surface { vec3 position; vec3 normal; float depth; bool seen; };

Surface surface_at(ivec2 pixel) {
    vec4 p = texelFetch(position, pixel, 0);
    return Surface(p.xyz, direction_from_octahedron(texelFetch(normals, pixel, 0).xy), texelFetch(depth, pixel, 0).x, p.w > 0.0);
}

// 1 for one plane, 0 where the other lies off the plane by more than a hundredth of its depth, or faces away.
float alike(Surface a, ivec2 pixel) {
    vec4 b = texelFetch(position, pixel, 0);
    float off = abs(dot(a.normal, b.xyz - a.position)) / (0.01 * a.depth);
    float facing = max(dot(a.normal, direction_from_octahedron(octahedron_of(b.w))), 0.0);
    return b.w > 0.0 ? max(1.0 - off, 0.0) * facing * facing * facing * facing : 0.0;
}
