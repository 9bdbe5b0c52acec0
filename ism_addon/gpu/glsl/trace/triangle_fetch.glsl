// Triangles in quanta of their meshes, two texels each: see packed_corners in mesh_buffers.py.
uniform usamplerBuffer corners;

struct TriangleVertices { vec3 first; vec3 u; vec3 v; int material; }; // first corner; edges from it to the others

TriangleVertices fetch_triangle(int triangle) {
    uvec4 one = texelFetch(corners, 2 * triangle), other = texelFetch(corners, 2 * triangle + 1);
    uvec4 last = (one & 127u) << uvec4(7, 14, 21, 28), material = (other & 127u) << uvec4(0, 7, 14, 21);
    ivec3 first = ivec3(one.xyz) >> 7;
    ivec3 second = ivec3(one.w, other.xy) >> 7;
    ivec3 third = ivec3(ivec2(other.zw) >> 7, int(last.x | last.y | last.z | last.w) >> 7);
    return TriangleVertices(vec3(first), vec3(second - first), vec3(third - first),
                   int(material.x | material.y | material.z | material.w));
}
