// Normals and tangents of object space, and the nodes Bump and Normal Map. As in Cycles.
#include "nodes/object.glsl"

// The normal of a surface that is raised by a height times a distance (Mikkelsen 2010). `_dx`, `_dy`: differences
// over the filter's width.
vec3 bump(float strength, float scale, float height, float height_dx, float height_dy, vec3 position, vec3 position_dx,
          vec3 position_dy, vec3 normal, float filter_width) {
    vec3 across_y = cross(position_dy, normal), across_x = cross(normal, position_dx);
    float det = dot(position_dx, across_y);
    vec3 slope = height_dx * across_y + height_dy * across_x;
    vec3 raised = abs(det) * normal - scale * (det < 0.0 ? -slope : slope);
    if (raised == vec3(0.0)) return normal;
    return vector_normalize(mix(normal, normalize(raised), max(strength, 0.0)));
}

// A normal for reflections: turned towards the triangle's until the mirror image of the camera is above the surface, as
// Cycles corrects what bumps it. With a cosine c to the triangle's normal the image is at the height `least` if
// 2 (c height + sqrt(1 - c^2) slant) c - height = least, an equation of second degree for c^2.
vec3 reflecting_normal(ShadingPoint at, vec3 normal) {
    float height = dot(at.incoming, at.geometric_normal), least = min(0.9 * height, 0.01);
    float cosine = dot(normal, at.geometric_normal);
    if (2.0 * dot(normal, at.incoming) * cosine - height >= least) return normal;
    vec3 across = vector_normalize(normal - cosine * at.geometric_normal);
    float slant = dot(at.incoming, across), a = slant * slant + height * height, b = a + least * height;
    float root = sqrt(max(b * b - a * (least + height) * (least + height), 0.0));
    float square = saturate(0.5 * (slant < 0.0 ? b + root : b - root) / max(a, 1e-30));
    return sqrt(1.0 - square) * across + sqrt(square) * at.geometric_normal;
}

vec3 unflipped(ShadingPoint at, vec3 normal) { return at.is_back ? -normal : normal; }

// A normal of object space, transformed by the cofactor matrix.
vec3 world_from_object_normal(ShadingPoint at, vec3 n) {
    mat3 m = anchor_from_object(at);
    float size = max(max(length(m[0]), length(m[1])), length(m[2]));
    m /= max(size, 1e-30);
    return vector_normalize(mat3(cross(m[1], m[2]), cross(m[2], m[0]), cross(m[0], m[1])) * n *
                            (determinant(m) < 0.0 ? -1.0 : 1.0));
}

// The direction in the surface that is nearest to one of object space.
vec3 surface_tangent(ShadingPoint at, vec3 v) {
    return cross(at.normal, vector_normalize(cross(world_from_object_normal(at, v), at.normal)));
}

vec3 or_surface_normal(ShadingPoint at, vec3 n) { return n == vec3(0.0) ? at.normal : n; }

// `tangent`: of the UV map, and the sign of the bitangent.
vec3 normal_map_tangent(ShadingPoint at, float strength, vec3 color, vec4 tangent) {
    vec3 mapped = 2.0 * color - 1.0, n = vector_normalize(unflipped(at, at.normal) * anchor_from_object(at));
    mapped = vec3(mapped.xy * strength, mix(1.0, mapped.z, saturate(strength)));
    vec3 result = mapped.x * tangent.xyz + mapped.y * tangent.w * cross(n, tangent.xyz) + mapped.z * n;
    return or_surface_normal(at, unflipped(at, world_from_object_normal(at, result)));
}

vec3 mixed_with_surface(ShadingPoint at, float strength, vec3 n) {
    vec3 result = unflipped(at, n);
    return or_surface_normal(at, vector_normalize(at.normal + (result - at.normal) * max(strength, 0.0)));
}

vec3 normal_map_object(ShadingPoint at, float strength, vec3 color) {
    return mixed_with_surface(at, strength, world_from_object_normal(at, 2.0 * color - 1.0));
}

vec3 normal_map_world(ShadingPoint at, float strength, vec3 color) {
    return mixed_with_surface(at, strength, vector_normalize(2.0 * color - 1.0));
}
