// What emissive triangles emit at points: a texel each.
#include "surfaces/shading_point.glsl"
#include "surfaces/surface_emission.glsl"
#include "maths/orthonormal_basis.glsl"
uniform usamplerBuffer points; // two texels each: triangle, instance, two barycentric coordinates; direction and side
uniform int columns;
out vec4 radiance;

void main() {
    int row = int(gl_FragCoord.y) * columns + int(gl_FragCoord.x);
    uvec4 one = texelFetch(points, 2 * row), other = texelFetch(points, 2 * row + 1);
    int triangle = int(one.x);
    vec2 st = uintBitsToFloat(one.zw);
    Instance instance = instance_at(int(one.y));
    mat3 linear = transpose(mat3(instance.row0.xyz, instance.row1.xyz, instance.row2.xyz));
    TriangleVertices corners = fetch_triangle(triangle);
    vec3 offset = vec3(instance.row0.w, instance.row1.w, instance.row2.w);
    vec3 position = linear * (corners.first + st.x * corners.u + st.y * corners.v) + offset;
    linear /= max(max(length(linear[0]), length(linear[1])), length(linear[2])); // quanta are small units
    // From the surface's front, on which mirrored instances have other normals.
    vec3 normal = normalize(cross(linear * corners.u, linear * corners.v)) * (determinant(linear) < 0.0 ? -1.0 : 1.0);
    vec3 incoming = basis(normal) * uintBitsToFloat(other.xyz) * (other.w == 0u ? 1.0 : -1.0);
    vec3 barycentric = vec3(1.0 - st.x - st.y, st);
    radiance = emission(corners.material, shading_point(triangle, int(one.y), barycentric, position, incoming));
}
