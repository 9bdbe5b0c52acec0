// The point of a surface that a ray meets, for graphs.
#include "maths/octahedron.glsl"
#include "nodes/point.glsl"
#include "surfaces/instances.glsl"
#include "trace/triangle_fetch.glsl"
uniform isamplerBuffer corner_normal_buffer;

// `barycentric`: of the point, at `position`; `incoming`: unit vector to where the ray comes from.
ShadingPoint shading_point(int triangle, int instance_index, vec3 barycentric, vec3 position, vec3 incoming) {
    Instance instance = instance_at(instance_index);
    mat3 linear = transpose(mat3(instance.row0.xyz, instance.row1.xyz, instance.row2.xyz));
    linear /= max(max(length(linear[0]), length(linear[1])), length(linear[2])); // quanta are small units
    // Normals are transformed by the cofactor matrix. A mirrored instance flips them, as it flips its triangles.
    mat3 cofactor = mat3(cross(linear[1], linear[2]), cross(linear[2], linear[0]), cross(linear[0], linear[1]));
    TriangleVertices corners = fetch_triangle(triangle);
    vec3 geometric_normal = normalize(cofactor * cross(corners.u, corners.v)), sum = vec3(0.0);
    for (int k = 0; k < 3; ++k) {
        vec2 octahedra = vec2(texelFetch(corner_normal_buffer, 3 * triangle + k).xy) / OCTAHEDRON_STEPS;
        sum += barycentric[k] * direction_from_octahedron(octahedra);
    }
    vec3 normal = normalize(cofactor * sum);
    float side = dot(geometric_normal, incoming) < 0.0 ? -1.0 : 1.0;
    bool is_back = (side < 0.0) != (determinant(linear) < 0.0);
    return ShadingPoint(position, barycentric, side * normal, side * geometric_normal, incoming, is_back,
                        triangle, instance_index);
}

// The same without barycentric coordinates.
ShadingPoint shading_point(int triangle, int instance_index, vec3 position, vec3 incoming) {
    Instance instance = instance_at(instance_index);
    mat3 linear = transpose(mat3(instance.row0.xyz, instance.row1.xyz, instance.row2.xyz));
    TriangleVertices corners = fetch_triangle(triangle);
    vec3 offset = vec3(instance.row0.w, instance.row1.w, instance.row2.w);
    vec3 u = linear * corners.u, v = linear * corners.v, p = position - (linear * corners.first + offset);
    vec3 n = cross(u, v), scaled = n / dot(n, n);
    float s = dot(cross(p, v), scaled), t = dot(cross(u, p), scaled);
    return shading_point(triangle, instance_index, vec3(1.0 - s - t, s, t), position, incoming);
}
