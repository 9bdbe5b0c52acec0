// Points spread evenly over the part of a triangle that is above the receiver's horizon.
struct TriangleSample { vec3 point; float fraction; }; // from the receiver; fraction of the area that is above

vec3 even_triangle_point(vec3 a, vec3 u, vec3 v, vec2 uv) {
    float root = sqrt(uv.x);
    return a + root * ((1.0 - uv.y) * u + uv.y * v);
}

// The corner a as seen from the receiver, the edges u and v from it to the others, and the receiver's normal n.
TriangleSample triangle_sample(vec3 a, vec3 u, vec3 v, vec3 n, vec2 uv) {
    vec3 corners[3] = vec3[3](a, a + u, a + v), heights = vec3(dot(n, a), dot(n, a + u), dot(n, a + v));
    bvec3 above = greaterThan(heights, vec3(0.0));
    int count = int(above.x) + int(above.y) + int(above.z);
    if (count == 3) return TriangleSample(even_triangle_point(a, u, v, uv), 1.0);
    // The corner that is alone on its side of the horizon, and where the edges from it meet the horizon.
    bool side = count == 1;
    int k = above.x == side ? 0 : above.y == side ? 1 : 2;
    vec3 first = corners[k], to_second = corners[(k + 1) % 3] - first, to_third = corners[(k + 2) % 3] - first;
    float height = heights[k];
    vec2 t = clamp(height / (height - vec2(heights[(k + 1) % 3], heights[(k + 2) % 3])), 0.0, 1.0);
    if (count == 0) return TriangleSample(first, 0.0);
    if (count == 1) return TriangleSample(even_triangle_point(first, t.x * to_second, t.y * to_third, uv), t.x * t.y);
    // Two triangles: horizon, second and third corner; and horizon, third corner, horizon.
    float one = 1.0 - t.x, other = t.x * (1.0 - t.y), share = one / max(one + other, 1e-30);
    bool in_one = uv.x < share;
    uv.x = clamp(in_one ? uv.x / share : (uv.x - share) / max(1.0 - share, 1e-30), 0.0, 0.99999994);
    vec3 start = first + t.x * to_second, to_corner = to_third - t.x * to_second;
    vec3 end = in_one ? (1.0 - t.x) * to_second : t.y * to_third - t.x * to_second;
    return TriangleSample(even_triangle_point(start, to_corner, end, uv), one + other);
}
