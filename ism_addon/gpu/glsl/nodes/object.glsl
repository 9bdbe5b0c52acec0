// Operations of nodes that depend on the object of a point.
#include "nodes/point.glsl"
#include "nodes/vectors.glsl"
#include "surfaces/instances.glsl"
#include "trace/triangle_fetch.glsl"
#ifdef IN_SCENE_RECORDS
#include "textures/scene_records.glsl"
uniform int object_info;
ObjectInfo object_info_at(int instance) { return fetch_ObjectInfo(scene_records, object_info + max(instance, 0)); }
#else
uniform usamplerBuffer object_info;
ObjectInfo object_info_at(int instance) { return fetch_ObjectInfo(object_info, instance); }
#endif

vec3 coordinate_object(ShadingPoint at) {
    ObjectInfo info = object_info_at(at.instance);
    TriangleVertices corners = fetch_triangle(at.triangle);
    vec3 quanta = corners.first + corners.u * at.barycentric.y + corners.v * at.barycentric.z;
    return info.centre + info.metres_per_quantum * quanta;
}

// Columns: the object's axes in anchor space, in one unit for all of them.
mat3 anchor_from_object(ShadingPoint at) {
    Instance instance = instance_at(at.instance);
    return transpose(mat3(instance.row0.xyz, instance.row1.xyz, instance.row2.xyz));
}

vec3 object_from_world_normal(ShadingPoint at, vec3 n) { return vector_normalize(n * anchor_from_object(at)); }
vec3 coordinate_normal(ShadingPoint at) { return object_from_world_normal(at, at.normal); }

// Columns: the object's axes in world space, metres.
mat3 world_axes(ShadingPoint at) {
    return anchor_from_object(at) / object_info_at(at.instance).metres_per_quantum;
}

vec3 world_from_object_vector(ShadingPoint at, vec3 v) { return world_axes(at) * v; }
vec3 object_from_world_vector(ShadingPoint at, vec3 v) { return inverse(world_axes(at)) * v; }

vec3 world_from_object_point(ShadingPoint at, vec3 p) {
    return world_axes(at) * p + object_info_at(at.instance).location;
}

vec3 object_from_world_point(ShadingPoint at, vec3 p) {
    return inverse(world_axes(at)) * (p - object_info_at(at.instance).location);
}

vec3 object_location(ShadingPoint at) { return object_info_at(at.instance).location; }
vec4 object_color(ShadingPoint at) { return object_info_at(at.instance).color; }
float object_index(ShadingPoint at) { return object_info_at(at.instance).index; }
float object_random(ShadingPoint at) { return object_info_at(at.instance).random; }
