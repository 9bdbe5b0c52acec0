// Fragments of instances.vert.
#if TRANSPARENCY
#include "surfaces/camera_ray.glsl"
#include "surfaces/shading_point.glsl"
#include "surfaces/transparency.glsl"
in vec3 position;
in vec3 barycentric;
#endif
flat in uvec2 triangle_and_instance;
uniform vec2 depth; // see depth.py

void write_depth() {
#if !REVERSED_DEPTH
    gl_FragDepth = depth.y < 0.0 ? depth.x - depth.y * log2(gl_FragCoord.w) : 1.0 - gl_FragCoord.z;
#endif
}

#if TRANSPARENCY
int material_of_triangle() { return fetch_triangle(int(triangle_and_instance.x) - 1).material; }

// The fraction of light that passes through a material to the camera; in alpha the limit of pass_probability.
vec4 passing(int material) {
    int triangle = int(triangle_and_instance.x) - 1, instance = int(triangle_and_instance.y);
    vec3 incoming = direction_to_camera(position);
    return transparency(material, shading_point(triangle, instance, barycentric, position, incoming));
}
#endif
