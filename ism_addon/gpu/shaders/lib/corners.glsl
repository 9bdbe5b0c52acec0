// Triangles in the steps of their meshes' lattices, in two texels each: see packed_corners in buffers.py.
uniform usampler2D corners;

struct Corners { vec3 first; vec3 u; vec3 v; int material; }; // a corner, and from it to the other two

// Where texel i is in the unit square, see fetch.glsl and array.glsl; `texel` is the size of one.
vec2 place_of(int i, vec2 texel) { return (vec2(i & (WIDTH - 1), i / WIDTH) + 0.5) * texel; }

Corners corners_of(int triangle, vec2 texel) {
    vec2 place = place_of(2 * triangle, texel);
    uvec4 one = textureLod(corners, place, 0.0), other = textureLod(corners, place + vec2(texel.x, 0.0), 0.0);
    uvec4 last = (one & 127u) << uvec4(7, 14, 21, 28), material = (other & 127u) << uvec4(0, 7, 14, 21);
    ivec3 first = ivec3(one.xyz) >> 7;
    ivec3 second = ivec3(one.w, other.xy) >> 7;
    ivec3 third = ivec3(ivec2(other.zw) >> 7, int(last.x | last.y | last.z | last.w) >> 7);
    return Corners(vec3(first), vec3(second - first), vec3(third - first),
                   int(material.x | material.y | material.z | material.w));
}
