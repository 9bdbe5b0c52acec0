// Height over a triangle, at barycentric b, of the curved surface that its smooth normals approximate.

// The maximum of two heights: half the height by Phong tessellation (Boubekeur & Alexa 2008), which is exact on a
// sphere, and the lowest of the three tangent planes, each raised above the triangle. Cycles offsets shadow rays by the
// same.
float terminator_offset(vec3 b, vec3 corners[3], vec3 corner_normals[3]) {
    vec3 p = b.x * corners[0] + b.y * corners[1] + b.z * corners[2];
    float bulge = 0.0, max_offset = 1e30;
    for (int k = 0; k < 3; ++k) {
        vec3 n = corner_normals[k];
        float above = max(max(dot(corners[(k + 1) % 3] - corners[k], n), dot(corners[(k + 2) % 3] - corners[k], n)), 0.0);
        float plane = dot(corners[k] - p, n);
        bulge += b[k] * plane;
        max_offset = min(max_offset, max(plane + above, 0.0));
    }
    return max(max_offset, 0.5 * bulge);
}

// The same along the smooth normal at b, which may point away from the side of the triangle that is seen, as normals that
// were edited by hand do: then downwards, so that rays start on that side all the same.
float offset_along_normal(vec3 b, vec3 corners[3], vec3 corner_normals[3], vec3 geometric_normal) {
    vec3 n = b.x * corner_normals[0] + b.y * corner_normals[1] + b.z * corner_normals[2];
    float side = dot(n, geometric_normal) > 0.0 ? 1.0 : -1.0;
    for (int k = 0; k < 3; ++k) corner_normals[k] *= side;
    return side * terminator_offset(b, corners, corner_normals);
}
