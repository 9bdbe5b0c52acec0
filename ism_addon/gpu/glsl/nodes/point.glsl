// A point of a surface at which a graph is evaluated, and what it reads there of the mesh. Shaders with IN_SCENE_RECORDS
// read all tables from the scene's records, because they have no samplers left.
uniform samplerBuffer uvs;
uniform samplerBuffer attributes; // `attribute_count` rows a corner
uniform int attribute_count;
#ifdef IN_SCENE_RECORDS
#include "textures/scene_records.glsl"
uniform int graph_constants;
vec4 graph_constant(int row) { return fetch_GraphConstant(scene_records, graph_constants + row).numbers; }
#else
uniform samplerBuffer graph_constants;
vec4 graph_constant(int row) { return texelFetch(graph_constants, row); }
#endif

// In anchor space. The normals are on the side that the camera sees.
struct ShadingPoint {
    vec3 position;
    vec3 barycentric; // in the triangle, or outside of it
    vec3 normal;
    vec3 geometric_normal;
    vec3 incoming; // unit vector to the camera
    bool is_back;  // whether the camera sees the back of the object's surface
    int triangle;
    int instance;
};

// A way along the triangle's plane.
struct Shift { vec3 position; vec3 barycentric; };

ShadingPoint shifted(ShadingPoint at, Shift shift, float scale) {
    at.position += scale * shift.position;
    at.barycentric += scale * shift.barycentric;
    return at;
}

// From a point to the next pixel's in x and y; and two ways of a pixel's size that are at right angles.
struct Differentials { Shift dx; Shift dy; Shift tangent; Shift bitangent; };

mat3x2 corner_uvs(int triangle) {
    return mat3x2(texelFetch(uvs, 3 * triangle).xy, texelFetch(uvs, 3 * triangle + 1).xy,
                  texelFetch(uvs, 3 * triangle + 2).xy);
}

vec3 uv_map(ShadingPoint at) { return vec3(corner_uvs(at.triangle) * at.barycentric, 0.0); }

vec4 mesh_attribute(ShadingPoint at, int index) {
    vec4 sum = vec4(0.0);
    for (int k = 0; k < 3; ++k)
        sum += at.barycentric[k] * texelFetch(attributes, (3 * at.triangle + k) * attribute_count + index);
    return sum;
}
