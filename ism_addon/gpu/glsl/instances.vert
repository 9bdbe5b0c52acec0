// From object space to clip space of the visibility buffer, see sampling.pixel_grid.PixelGrid. An instance's rows are
// its transformation. There are no vertex and index buffers: they would take as much memory as `corners`, which is the
// largest buffer of a large scene.
#include "surfaces/instances.glsl"
#include "trace/triangle_fetch.glsl"
uniform int first_instance;
uniform bool is_multi_draw; // of small meshes with one instance each: `owners` has each triangle's instance
uniform usamplerBuffer owners;
uniform mat2 rotation;
uniform vec2 shift;
uniform vec2 depth; // see depth.py
flat out uvec2 triangle_and_instance; // index of the triangle plus 1; index of the instance
#if TRANSPARENCY
invariant gl_Position; // surfaces that tint are drawn again, and compared with the depth that they have left
out vec3 position;     // in anchor space
out vec3 barycentric;
#endif

void main() {
    int triangle = gl_VertexID / 3, corner = gl_VertexID - 3 * triangle;
    int index = is_multi_draw ? int(texelFetch(owners, triangle).x) : first_instance + gl_InstanceID;
    Instance instance = instance_at(index);
    triangle_and_instance = uvec2(triangle + 1, index);
    TriangleVertices vertices = fetch_triangle(triangle);
    vec4 p = vec4(vertices.first + (corner == 0 ? vec3(0.0) : corner == 1 ? vertices.u : vertices.v), 1.0);
    vec3 in_anchor = vec3(dot(instance.row0, p), dot(instance.row1, p), dot(instance.row2, p));
#if TRANSPARENCY
    position = in_anchor;
    barycentric = vec3(corner == 0, corner == 1, corner == 2);
#endif
    gl_Position = clip_from_anchor * vec4(in_anchor, 1.0);
#if REVERSED_DEPTH
    gl_Position.z = depth.x > 0.0 ? depth.x + depth.y * gl_Position.w : 0.5 * (gl_Position.w - gl_Position.z);
#endif
    gl_Position.xy = rotation * gl_Position.xy + shift * gl_Position.w;
}
