// Operations of nodes that give what is known of a point: its surface and the camera. As in Cycles.
#include "nodes/point.glsl"
#include "nodes/vectors.glsl"
#include "materials/fresnel.glsl"

vec3 geometry_position(ShadingPoint at) { return at.position + anchor.xyz; }
vec3 geometry_normal(ShadingPoint at) { return at.normal; }
vec3 geometry_true_normal(ShadingPoint at) { return at.geometric_normal; }
vec3 geometry_incoming(ShadingPoint at) { return at.incoming; }
vec3 geometry_parametric(ShadingPoint at) { return vec3(at.barycentric.xy, 0.0); }
float geometry_backfacing(ShadingPoint at) { return float(at.is_back); }
vec3 coordinate_reflection(ShadingPoint at) { return -reflect(at.incoming, at.normal); }

// Of camera space, the z axis of nodes is along the view.
const vec3 CAMERA_AXES = vec3(1.0, 1.0, -1.0);

vec3 coordinate_camera(ShadingPoint at) { return CAMERA_AXES * (view_from_anchor * vec4(at.position, 1.0)).xyz; }
vec3 camera_from_world_vector(vec3 v) { return CAMERA_AXES * (mat3(view_from_anchor) * v); }
vec3 camera_from_world_normal(vec3 v) { return vector_normalize(camera_from_world_vector(v)); }

vec3 camera_from_world_point(vec3 p) {
    return CAMERA_AXES * (view_from_anchor * vec4(p - anchor.xyz, 1.0)).xyz;
}

// The view's matrix is rigid: from the left, vectors are multiplied by its inverse.
vec3 world_from_camera_vector(vec3 v) { return (CAMERA_AXES * v) * mat3(view_from_anchor); }
vec3 world_from_camera_normal(vec3 v) { return vector_normalize(world_from_camera_vector(v)); }

vec3 world_from_camera_point(vec3 p) {
    return world_from_camera_vector(p - CAMERA_AXES * view_from_anchor[3].xyz) + anchor.xyz;
}

vec3 coordinate_window(ShadingPoint at) {
    vec4 p = clip_from_anchor * vec4(at.position, 1.0);
    return vec3(0.5 * p.xy / p.w + 0.5, 0.0);
}

// A position in the space of another object: of `row0` to `row2`, its matrix from world space.
vec3 coordinate_of_object(ShadingPoint at, vec4 row0, vec4 row1, vec4 row2) {
    vec4 world = vec4(geometry_position(at), 1.0);
    return vec3(dot(row0, world), dot(row1, world), dot(row2, world));
}

float fresnel(ShadingPoint at, float ior, vec3 normal) {
    float eta = max(ior, 1e-5);
    return fresnel_dielectric(abs(dot(at.incoming, normal)), at.is_back ? 1.0 / eta : eta);
}

float layer_weight_fresnel(ShadingPoint at, float blend, vec3 normal) {
    float eta = max(1.0 - blend, 1e-5);
    return fresnel_dielectric(abs(dot(at.incoming, normal)), at.is_back ? eta : 1.0 / eta);
}

float layer_weight_facing(ShadingPoint at, float blend, vec3 normal) {
    float cosine = abs(dot(at.incoming, normal)), limited = clamp(blend, 0.0, 1.0 - 1e-5);
    float exponent = limited < 0.5 ? 2.0 * limited : 0.5 / (1.0 - limited);
    return 1.0 - math_power(cosine, exponent);
}

float ray_length(ShadingPoint at) { return length(coordinate_camera(at)); }
