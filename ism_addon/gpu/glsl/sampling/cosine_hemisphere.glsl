// Directions of the hemisphere about z, distributed in proportion to the cosine (Malley's method).
vec3 cosine_hemisphere(vec2 uv) {
    float angle = 6.283185307179586 * uv.y;
    return vec3(sqrt(uv.x) * vec2(cos(angle), sin(angle)), sqrt(1.0 - uv.x));
}

// 1/sr, of directions above the horizon. `cosine`: of the angle to the hemisphere's axis.
float cosine_hemisphere_pdf(float cosine) { return 0.3183098861837907 * cosine; }
