#include "maths/octahedron.glsl"
#include "maths/packed_normal.glsl"

// How far a surface at p and `there`, a position with its normal packed in alpha, are one: 1 on one plane, 0 where it lies
// off the plane by more than a hundredth of p's depth, or faces away.
float alike(vec3 p, vec3 normal, float depth, vec4 there) {
    float off = abs(dot(normal, there.xyz - p)) / (0.01 * depth);
    float facing = max(dot(normal, direction_from_octahedron(octahedron_of(there.w))), 0.0);
    return there.w > 0.0 ? max(1.0 - off, 0.0) * facing * facing * facing * facing : 0.0;
}
