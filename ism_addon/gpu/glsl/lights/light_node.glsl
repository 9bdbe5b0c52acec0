// Estimates of the light of a node of a light BVH, from the moments of its triangles: see emission/light_bvh.py.

// The largest cosine to the receiver's normal of a part of a sphere above the horizon, about in proportion to that part.
// Distances in m; `height`: of its centre over the horizon.
float cosine_above_horizon(float height, float radius, float distance) {
    float part = max(height + radius, 0.0);
    return min((height >= radius ? height : 0.25 * part * part / radius) / distance, 1.0);
}

// A symmetric matrix times a vector.
vec3 symmetric_product(vec3 squares, vec3 products, vec3 v) {
    return squares * v + vec3(products.x * v.y + products.z * v.z, products.x * v.x + products.y * v.z,
                              products.z * v.x + products.y * v.y);
}

// The cosines of a node's triangles to a direction count as evenly distributed, with the mean and the variance that they
// have. x: the mean, weighted by area; y: half of their range.
vec2 node_cosines(LightNode node, vec3 wi) {
    float area = max(node.area, 1e-37), mean = -dot(node.normal, wi) / area;
    float square = dot(symmetric_product(node.normal_squares, node.normal_products, wi), wi) / area;
    return vec2(mean, sqrt(3.0 * max(square - mean * mean, 0.0)));
}

// The area of a node as seen along a direction, m^2.
float projected_area(LightNode node, vec2 cosines, bool one_sided) {
    float mean = abs(cosines.x), half_range = cosines.y;
    float absolute = mean < half_range ? 0.5 * (mean * mean / half_range + half_range) : mean;
    return node.area * (one_sided ? 0.5 * (absolute + cosines.x) : absolute);
}

// The cosine of a node's mean normal to the receiver, less or more than that of any triangle by at most `slack`.
struct NodeFacing { float cosine; float slack; };

NodeFacing node_facing(LightNode node, vec3 to, float inverse_distance) {
    float size = max(dot(node.normal, node.normal), 1e-37);
    return NodeFacing(-dot(node.normal, to) * inversesqrt(size) * inverse_distance,
                      node.normal_sine + node.radius * inverse_distance);
}

// Estimated irradiance of a node, and its importance, which is not 0 where any of its triangles illuminates p.
vec2 estimate_node(LightNode node, vec3 p, vec3 n, bool enclosed) {
    vec3 to = node.centre - p;
    float square = max(dot(to, to), 1e-30), inverse = inversesqrt(square), radius_square = node.radius * node.radius;
    float cosine = cosine_above_horizon(dot(n, to), max(node.radius, 1e-30), 1.0 / inverse);
    bool one_sided = node.one_sided != 0 && !enclosed;
    float area = projected_area(node, node_cosines(node, to * inverse), one_sided);
    NodeFacing facing = node_facing(node, to, inverse);
    if (one_sided && facing.cosine <= -facing.slack) return vec2(0.0);
    float rest = abs(facing.cosine) < facing.slack ? 0.2 * node.area * min(node.radius * inverse, 1.0) : 0.0;
    return cosine * vec2(area / max(square, 0.25 * radius_square), (area + rest) / max(square, radius_square));
}

// The irradiance of a node whose triangles all face the receiver, or all the other way, above the horizon: the Taylor
// series of N . x n . x / |x|^4 up to second moments. x: from the receiver to the centre.
float facing_node_irradiance(LightNode node, vec3 x, vec3 n) {
    float inverse = 1.0 / dot(x, x), height = dot(n, x), along = dot(node.normal, x) / node.area;
    vec3 unit = node.normal / node.area, cx = symmetric_product(node.position_squares, node.position_products, x);
    vec3 cn = symmetric_product(node.position_squares, node.position_products, n);
    float trace = node.position_squares.x + node.position_squares.y + node.position_squares.z;
    float positions = dot(unit, cn) - 4.0 * inverse * (height * dot(cx, unit) + along * dot(cx, n)) +
                      2.0 * along * height * inverse * (6.0 * inverse * dot(cx, x) - trace);
    // The row vector x^T normal_position, and its trace.
    vec3 xd = x.x * node.normal_x_position + x.y * node.normal_y_position + x.z * node.normal_z_position;
    float both = node.normal_x_position.x + node.normal_y_position.y + node.normal_z_position.z;
    float normals = height * both + dot(xd, n) - 4.0 * height * inverse * dot(xd, x);
    return abs(node.area * along * height + positions + normals) * inverse * inverse;
}
