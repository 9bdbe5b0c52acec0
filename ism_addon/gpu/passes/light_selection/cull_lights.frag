// Bounding boxes and normal cones of a tile's surfaces, of the near and of the far ones.
#include "textures/tile_index.glsl"
#include "maths/octahedron.glsl"
#include "maths/packed_normal.glsl"
uniform sampler2D position; // in alpha, the normal, packed
uniform sampler2D depth;
layout(location = 0) out vec4 tile_min; // in alpha, whether there is any surface
layout(location = 1) out vec4 tile_max;
layout(location = 2) out vec4 tile_normal_cone; // axis: the first normal; in alpha, the cosine of the cone's half angle
layout(location = 3) out vec4 far_tile_min;
layout(location = 4) out vec4 far_tile_max;
layout(location = 5) out vec4 far_tile_normal_cone;

void extend_bounds(vec3 p, vec3 n, inout vec4 low, inout vec4 high, inout vec4 cone) {
    if (low.w == 0.0) cone.xyz = n;
    cone.w = min(cone.w, dot(cone.xyz, n));
    low = vec4(min(low.xyz, p), 1.0);
    high.xyz = max(high.xyz, p);
}

void main() {
    ivec2 first = tile_index() * TILE_SIZE, last = last_pixel();
    vec2 texel = texel_size(position), range = vec2(1e30, -1e30);
    for (int k = 0; k < TILE_SIZE * TILE_SIZE; ++k) {
        float z = fetch(depth, min(first + ivec2(k % TILE_SIZE, k / TILE_SIZE), last), texel).x;
        if (z < BACKGROUND_DEPTH) range = vec2(min(range.x, z), max(range.y, z));
    }
    float split_depth = range.y > DEPTH_SPLIT_RATIO * range.x ? 0.5 * (range.x + range.y) : BACKGROUND_DEPTH;
    tile_min = far_tile_min = vec4(vec3(1e15), 0.0);
    tile_max = far_tile_max = vec4(-1e15);
    tile_normal_cone = far_tile_normal_cone = vec4(0.0, 0.0, 1.0, 1.0);
    for (int k = 0; k < TILE_SIZE * TILE_SIZE; ++k) {
        ivec2 at = min(first + ivec2(k % TILE_SIZE, k / TILE_SIZE), last);
        vec4 p = fetch(position, at, texel);
        if (p.w == 0.0) continue;
        vec3 n = direction_from_octahedron(unpack_normal(p.w));
        if (fetch(depth, at, texel).x < split_depth) extend_bounds(p.xyz, n, tile_min, tile_max, tile_normal_cone);
        else extend_bounds(p.xyz, n, far_tile_min, far_tile_max, far_tile_normal_cone);
    }
}
