// What Voronoi textures have in common: a grid, each cell of which has a point, as in Cycles. See shading/textures.py.
#include "nodes/procedural/hash.glsl"
#include "nodes/procedural/texture_point.glsl"

// The options, which are known when the shader is compiled: the number of dimensions and the bits before it.
int voronoi_dimensions(int options) { return options & 7; }
int voronoi_metric(int options) { return options >> 3 & 3; }
bool is_normalized(int options) { return (options & 32) != 0; }
bool has_integer_hash(int options) { return (options & 64) != 0; } // Cycles' newer releases

// Larger than all distances.
const float NO_DISTANCE = 3e38;

// The point of a cell, inside of it, 0 to 1.
vec4 cell_point(ivec4 cell, int options) {
    int dimensions = voronoi_dimensions(options);
    vec4 k = vec4(cell);
    if (dimensions == 1) return vec4(hash_number(k, 1), 0.0, 0.0, 0.0);
    if (has_integer_hash(options)) {
        if (dimensions == 2) return vec4(pcg_hash(cell.xy), 0.0, 0.0);
        return dimensions == 3 ? vec4(pcg_hash(cell.xyz), 0.0) : pcg_hash(cell);
    }
    if (dimensions == 2) return vec4(hash_number(k, 2), hash_number(k, 2, 1.0), 0.0, 0.0);
    if (dimensions == 3) return vec4(hash_color(k, 3), 0.0);
    return vec4(hash_number(k, 4), hash_number(k.wxyz, 4), hash_number(k.zwxy, 4), hash_number(k.yzwx, 4));
}

vec3 cell_color(ivec4 cell, int options) {
    int dimensions = voronoi_dimensions(options);
    if (dimensions == 1 || !has_integer_hash(options)) return hash_color(vec4(cell), dimensions);
    return dimensions == 4 ? pcg_hash(cell).xyz : pcg_hash(cell.xyz);
}

// Number of cells that are at most `radius` cells away along each axis, and the way to each of these.
int cell_count(int radius, int options) {
    int side = 2 * radius + 1, plane = side * side, dimensions = voronoi_dimensions(options);
    return (dimensions > 1 ? plane : side) * (dimensions == 3 ? side : dimensions == 4 ? plane : 1);
}

ivec4 cell_offset(int index, int radius, int options) {
    int side = 2 * radius + 1;
    ivec4 offset = ivec4(index, index / side, index / (side * side), index / (side * side * side)) % side - radius;
    return offset * ivec4(has_dimension(voronoi_dimensions(options)));
}

// The point of another cell, from the corner of this cell.
vec4 point_in(ivec4 cell, ivec4 offset, float randomness, int options) {
    return vec4(offset) + cell_point(cell + offset, options) * randomness;
}
