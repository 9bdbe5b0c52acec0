// Directions of a hemisphere in proportion to the cosine (Malley).
#include "maths/orthonormal_basis.glsl"

vec3 cosine_hemisphere(vec3 n, vec2 uv) {
    float angle = 6.283185307179586 * uv.y;
    return basis(n) * vec3(sqrt(uv.x) * vec2(cos(angle), sin(angle)), sqrt(1.0 - uv.x));
}

// 1/sr
float cosine_hemisphere_pdf(vec3 n, vec3 wi) { return 0.3183098861837907 * max(dot(n, wi), 0.0); }
