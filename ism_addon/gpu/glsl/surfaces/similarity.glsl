#include "maths/octahedron.glsl"
#include "maths/packed_normal.glsl"

// Similarity of a surface at p to `other`, a position with the normal packed in alpha: 1 on the same plane; 0 if its
// distance from p's plane is more than a hundredth of p's depth, or if it faces away.
float similarity(vec3 p, vec3 normal, float depth, vec4 other) {
    float off_plane = abs(dot(normal, other.xyz - p)) / (0.01 * depth);
    float cosine = max(dot(normal, direction_from_octahedron(unpack_normal(other.w))), 0.0);
    return other.w > 0.0 ? max(1.0 - off_plane, 0.0) * cosine * cosine * cosine * cosine : 0.0;
}
