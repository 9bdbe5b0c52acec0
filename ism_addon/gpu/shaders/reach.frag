// What a block shows nearby, and above that in the target, far off: the box around it, and the cone of its normals.
#include "lib/octahedron.glsl"
uniform sampler2D position;
uniform sampler2D normals;
uniform sampler2D depth;
uniform int rows; // of blocks
layout(location = 0) out vec4 lowest; // in alpha, whether there is any surface
layout(location = 1) out vec4 highest;
layout(location = 2) out vec4 facing; // the first normal; in alpha, the cosine of the cone's half angle about it

void main() {
    ivec2 here = ivec2(gl_FragCoord.xy), last = textureSize(position, 0) - 1;
    bool far = here.y >= rows;
    ivec2 first = ivec2(here.x, far ? here.y - rows : here.y) * BLOCK;
    vec2 texel = texel_size(position), depths = vec2(1e30, -1e30);
    for (int k = 0; k < BLOCK * BLOCK; ++k) {
        ivec2 at = min(first + ivec2(k % BLOCK, k / BLOCK), last);
        float z = fetch(depth, at, texel).x;
        if (z < FAR_AWAY) depths = vec2(min(depths.x, z), max(depths.y, z));
    }
    float middle = depths.y > SPLIT * depths.x ? 0.5 * (depths.x + depths.y) : FAR_AWAY;
    vec2 range = far ? vec2(middle, FAR_AWAY) : vec2(-1e30, middle);
    lowest = vec4(vec3(1e15), 0.0);
    highest = vec4(-1e15);
    facing = vec4(0.0, 0.0, 1.0, 1.0);
    for (int k = 0; k < BLOCK * BLOCK; ++k) {
        ivec2 at = min(first + ivec2(k % BLOCK, k / BLOCK), last);
        float z = fetch(depth, at, texel).x;
        if (z < range.x || z >= range.y) continue;
        vec3 p = fetch(position, at, texel).xyz, n = direction_from_octahedron(fetch(normals, at, texel).xy);
        if (lowest.w == 0.0) facing.xyz = n;
        facing.w = min(facing.w, dot(facing.xyz, n));
        lowest = vec4(min(lowest.xyz, p), 1.0);
        highest.xyz = max(highest.xyz, p);
    }
}
