// Linearly transformed cosines of GGX without Fresnel, times the cosine of the light (Heitz, Dupuy, Hill & Neubelt 2016).

// The inverse matrix, from an entry of the table: a, b, c, d of [[a, 0, b], [0, 1, 0], [c, 0, d]]. z is the normal, x is the
// viewer's direction projected onto the surface. Its integral is 1; the lobe's is ggx_albedo.
vec4 ltc_inverse_of(vec4 entry, float roughness, float cos_view) {
    float cosine = clamp(cos_view, 0.0, 1.0), sine = sqrt(1.0 - cosine * cosine), alpha = roughness * roughness;
    vec4 m = entry * vec4(1.0, vec3(alpha)); // in coordinates where z is the mirror direction
    return vec4(m.x * cosine - m.y * sine, m.x * sine + m.y * cosine, m.z * cosine - m.w * sine,
                m.z * sine + m.w * cosine);
}
