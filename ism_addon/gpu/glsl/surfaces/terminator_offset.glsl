// How far the curved surface that a triangle's normals speak of stands out over the triangle, at barycentric b.

// Half of what Phong tessellation (Boubekeur & Alexa 2008) says, which is right on a sphere; or more, as far as all three
// tangent planes, each raised to clear the triangle, leave room. Cycles lifts its shadow rays by the same.
float terminator_offset(vec3 b, vec3 corners[3], vec3 corner_normals[3]) {
    vec3 p = b.x * corners[0] + b.y * corners[1] + b.z * corners[2];
    float bulge = 0.0, room = 1e30;
    for (int k = 0; k < 3; ++k) {
        vec3 n = corner_normals[k];
        float above = max(max(dot(corners[(k + 1) % 3] - corners[k], n), dot(corners[(k + 2) % 3] - corners[k], n)), 0.0);
        float plane = dot(corners[k] - p, n);
        bulge += b[k] * plane;
        room = min(room, max(plane + above, 0.0));
    }
    return max(room, 0.5 * bulge);
}
