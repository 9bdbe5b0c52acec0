// A pixel's surface, from the G-buffer. Compilers omit the fetches of members that a shader does not use.
#include "maths/octahedron.glsl"
#include "surfaces/similarity.glsl"
uniform sampler2D position; // in alpha, the normal, packed
uniform sampler2D base_color; // in alpha, the terminator offset
uniform usampler2D normal; // shading and geometric normal, packed; index of the triangle plus 1, and of its instance

struct Surface {
    vec3 position;
    vec3 normal;
    vec3 geometric_normal;
    vec3 base_color;
    float depth;
    float terminator_offset;
    int triangle;
    int instance;
    bool exists;
};

Surface surface_at(ivec2 at) {
    vec4 p = fetch(position, at), color = fetch(base_color, at);
    uvec4 ids = fetch(normal, at);
    return Surface(p.xyz, direction_from_octahedron(unpack_octahedron(ids.x)),
                   direction_from_octahedron(unpack_octahedron(ids.y)), color.rgb,
                   -(view_from_anchor * vec4(p.xyz, 1.0)).z, color.a, int(ids.z) - 1, int(ids.w), p.w > 0.0);
}

// Similarity of a surface to the surface of another pixel.
float similarity(Surface surface, ivec2 other, vec2 texel) {
    return similarity(surface.position, surface.normal, surface.depth, fetch(position, other, texel));
}
