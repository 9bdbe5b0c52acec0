// A pixel's surface, from the G-buffer. Compilers omit the fetches of members that a shader does not use.
#include "maths/octahedron.glsl"
#include "surfaces/similarity.glsl"
uniform sampler2D position; // in alpha, the normal, packed
uniform sampler2D normal;
uniform sampler2D depth;
uniform sampler2D base_color; // in alpha, the terminator offset
uniform usampler2D primitive;

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
    vec4 p = fetch(position, at), octahedra = fetch(normal, at), color = fetch(base_color, at);
    uvec2 id = fetch(primitive, at).xy;
    return Surface(p.xyz, direction_from_octahedron(octahedra.xy), direction_from_octahedron(octahedra.zw),
                   color.rgb, fetch(depth, at).x, color.a, int(id.x) - 1, int(id.y), p.w > 0.0);
}

// Similarity of a surface to the surface of another pixel.
float similarity(Surface surface, ivec2 other, vec2 texel) {
    return similarity(surface.position, surface.normal, surface.depth, fetch(position, other, texel));
}
