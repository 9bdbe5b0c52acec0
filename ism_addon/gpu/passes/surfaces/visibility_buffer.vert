// Object to clip space of the fine picture, see sampling.pixel_grid.PixelGrid. The mesh stands where its instance's rows
// say. Without vertices or indices: they would take as much memory as the corners, which is all that there is of a large
// scene.
#include "trace/triangle_fetch.glsl"
uniform usamplerBuffer instances;
uniform int first_instance;
uniform bool together; // small meshes that stand once: their triangles say whose they are
uniform usamplerBuffer owners;
uniform mat2 rotation;
uniform vec2 shift;
uniform vec2 depth; // see depth.py
flat out uvec2 numbers; // of the triangle and the instance

void main() {
    int triangle = gl_VertexID / 3, corner = gl_VertexID - 3 * triangle;
    int instance = together ? int(texelFetch(owners, triangle).x) : first_instance + gl_InstanceID;
    Instance here = fetch_Instance(instances, instance);
    numbers = uvec2(triangle + 1, instance);
    TriangleVertices corners_here = fetch_triangle(triangle);
    vec4 p = vec4(corners_here.first + (corner == 0 ? vec3(0.0) : corner == 1 ? corners_here.u : corners_here.v), 1.0);
    gl_Position = clip_from_anchor * vec4(dot(here.row0, p), dot(here.row1, p), dot(here.row2, p), 1.0);
#if REVERSED_DEPTH
    gl_Position.z = depth.x > 0.0 ? depth.x + depth.y * gl_Position.w : 0.5 * (gl_Position.w - gl_Position.z);
#endif
    gl_Position.xy = rotation * gl_Position.xy + shift * gl_Position.w;
}
