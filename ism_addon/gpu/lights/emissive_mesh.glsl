// Emissive meshes of uniform radiance. Few triangles have a closed form together, and one is chosen for a sample by its
// irradiance. More have a light BVH: their irradiance is estimated from its root, which the irradiance cache corrects,
// and a triangle is chosen by importance, from node to node.
#include "lights/emissive_limits.glsl"
#include "closed_forms/triangle.glsl"
#include "sampling/discrete.glsl"
#include "sampling/triangle.glsl"
#ifndef MESHES_WITH_BVH
#define MESHES_WITH_BVH 1
#endif
#ifndef MESHES_WITHOUT_BVH
#define MESHES_WITHOUT_BVH 1
#endif
#ifndef ESTIMATE_NODES
#define ESTIMATE_NODES MAX_NODES // see estimate_light_bvh
#endif
const int MAX_NODES = 16;

bool has_light_bvh(Light light) { return MESHES_WITHOUT_BVH == 0 || (MESHES_WITH_BVH == 1 && light.leaves > 0); }

// Whether one-sided triangles emit from both sides: in the box around closed meshes.
bool emissive_mesh_encloses(Light light, vec3 p) {
    return all(greaterThan(p, light.axis_u)) && all(lessThan(p, light.axis_v));
}

bool emits_towards(EmissiveTriangle triangle, vec3 p, bool enclosed) {
    return triangle.one_sided == 0 || enclosed || dot(cross(triangle.u, triangle.v), p - triangle.corner) > 0.0;
}

// Whether p lies in the triangle's plane, up to rounding errors, so that it sees nothing of the triangle.
bool is_edge_on(EmissiveTriangle triangle, vec3 p) {
    vec3 normal = cross(triangle.u, triangle.v);
    float height = dot(normal, triangle.corner - p), rounding = 1e-6 * (abs(p.x) + abs(p.y) + abs(p.z));
    return height * height <= rounding * rounding * dot(normal, normal);
}

// See triangle_irradiance. Errors of the many triangles of a light BVH are smaller together.
const float SMALL_TRIANGLE = MESHES_WITHOUT_BVH == 0 ? 2e-2 : 2e-3;

float emissive_triangle_irradiance(int row, vec3 p, vec3 n, bool enclosed) {
    EmissiveTriangle triangle = fetch_EmissiveTriangle(scene_records, emissive_triangles + row);
    if (is_edge_on(triangle, p) || !emits_towards(triangle, p, enclosed)) return 0.0;
    return triangle_irradiance(triangle.corner - p, triangle.u, triangle.v, n, SMALL_TRIANGLE);
}

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

float light_node_importance(int row, vec3 p, vec3 n, bool enclosed) {
    return estimate_node(fetch_LightNode(scene_records, light_nodes + row), p, n, enclosed).y;
}

float emissive_triangles_irradiance(int first, int count, vec3 p, vec3 n, bool enclosed) {
    float sum = 0.0;
    for (int k = first; k < first + count; ++k) sum += emissive_triangle_irradiance(k, p, n, enclosed);
    return sum;
}

// Estimated irradiance of a light BVH: the sum over `nodes` nodes, all of one depth, from the root at 1 to MAX_NODES.
float estimate_light_bvh(Light light, vec3 p, vec3 n, int nodes) {
    bool enclosed = emissive_mesh_encloses(light, p);
    float sum = 0.0;
    for (int node = nodes; node < 2 * nodes; ++node) {
        LightNode bounds = fetch_LightNode(scene_records, light_nodes + light.first_node + node);
        sum += estimate_node(bounds, p, n, enclosed).x;
    }
    return min(sum, 3.141592653589793);
}

float emissive_mesh_irradiance(Light light, vec3 p, vec3 n) {
    if (has_light_bvh(light)) return estimate_light_bvh(light, p, n, ESTIMATE_NODES);
    bool enclosed = emissive_mesh_encloses(light, p);
    return emissive_triangles_irradiance(light.first_triangle, light.triangle_count, p, n, enclosed);
}

// The same without the estimate's error: by nodes that face the receiver and are seen as smaller than MAX_NODE_SIZE, and
// by the triangles of other leaves. These have separate loops, which drivers that execute both branches of an "if" can
// skip.
const float MAX_NODE_SIZE = 0.15, MAX_EDGE_NODE_SIZE = 0.05, MAX_HORIZON_NODE_SIZE = 0.0015; // radius over distance
const float MAX_EDGE_NODE_SLACK = 0.2;

float emissive_mesh_accurate_irradiance(Light light, vec3 p, vec3 n) {
    bool enclosed = emissive_mesh_encloses(light, p);
    int per_leaf = light.triangle_count / light.leaves, node = 1;
    float sum = 0.0;
    while (node > 0) {
        bool is_leaf = false;
        int leaf = 0;
        while (node > 0 && !is_leaf) {
            LightNode bounds = fetch_LightNode(scene_records, light_nodes + light.first_node + node);
            vec3 to = bounds.centre - p;
            float square = max(dot(to, to), 1e-30), height = dot(n, to), reach = bounds.radius * inversesqrt(square);
            NodeFacing facing = node_facing(bounds, to, inversesqrt(square));
            bool faces = abs(facing.cosine) > facing.slack; // all triangles do, or all face the other way
            bool is_hidden = height <= -bounds.radius || bounds.area <= 0.0 ||
                             (faces && facing.cosine < 0.0 && bounds.one_sided != 0 && !enclosed);
            bool is_small = reach < MAX_NODE_SIZE && faces && height >= bounds.radius;
            // Of nodes at the horizon, or whose triangles do not all face p, what is small and flat is estimated.
            bool is_tiny = reach < (height >= bounds.radius ? MAX_EDGE_NODE_SIZE : MAX_HORIZON_NODE_SIZE) &&
                           facing.slack < MAX_EDGE_NODE_SLACK;
            bool is_done = is_hidden || is_small || is_tiny;
            is_leaf = !is_done && node >= light.leaves;
            float irradiance = is_small ? facing_node_irradiance(bounds, to, n) : estimate_node(bounds, p, n, enclosed).x;
            sum += !is_hidden && (is_small || is_tiny) ? irradiance : 0.0;
            leaf = node - light.leaves;
            // To a child, or to the next node that is no descendant.
            int after = (node + 1) >> findLSB(node + 1);
            node = is_done || is_leaf ? (after == 1 ? 0 : after) : 2 * node;
        }
        sum += emissive_triangles_irradiance(
            light.first_triangle + leaf * per_leaf, is_leaf ? per_leaf : 0, p, n, enclosed);
    }
    return sum;
}

// Number of nodes, descendants of one node at the same depth, from which one is chosen by importance.
const int NODES_AT_ONCE = 8;

int nodes_at_once(Light light, int node) { return min(NODES_AT_ONCE, light.leaves >> findMSB(node)); }

// Triangles to choose from by irradiance, and the probability of these among all.
struct TriangleRange { int first; int count; float probability; };

// `choice` in [0,1): is replaced by another one, for the triangle in the range.
TriangleRange choose_leaf(Light light, vec3 p, vec3 n, bool enclosed, inout float choice) {
    if (!has_light_bvh(light)) return TriangleRange(light.first_triangle, light.triangle_count, 1.0);
    int node = 1;
    float probability = 1.0, importances[MAX_EXACT_TRIANGLES];
    while (node < light.leaves) {
        int count = nodes_at_once(light, node);
        node *= count;
        for (int k = 0; k < count; ++k)
            importances[k] = light_node_importance(light.first_node + node + k, p, n, enclosed);
        DiscreteSample chosen = sample_discrete(importances, count, choice);
        probability *= chosen.probability;
        node += chosen.index;
    }
    int count = light.triangle_count / light.leaves;
    return TriangleRange(light.first_triangle + (node - light.leaves) * count, count, probability);
}

LightSample emissive_mesh_sample(Light light, vec3 p, vec3 n, vec2 uv) {
    bool enclosed = emissive_mesh_encloses(light, p);
    TriangleRange range = choose_leaf(light, p, n, enclosed, uv.x);
    float irradiances[MAX_EXACT_TRIANGLES];
    for (int k = 0; k < range.count; ++k)
        irradiances[k] = emissive_triangle_irradiance(range.first + k, p, n, enclosed);
    DiscreteSample chosen = sample_discrete(irradiances, range.count, uv.x);
    EmissiveTriangle triangle = fetch_EmissiveTriangle(scene_records, emissive_triangles + range.first + chosen.index);
    TriangleSample of_triangle = triangle_sample(triangle.corner - p, triangle.u, triangle.v, n, uv);
    vec3 to = of_triangle.point, normal_area = 0.5 * cross(triangle.u, triangle.v);
    float square = max(dot(to, to), 1e-30), distance = sqrt(square);
    float projected = of_triangle.fraction * abs(dot(normal_area, to)) / distance;
    float pdf = range.probability * chosen.probability * square / max(projected, 1e-37);
    vec3 point = p + to;
    // A shadow ray must not hit the triangle itself: it ends before it by the rounding errors.
    float area = length(normal_area), height = dot(normal_area, -to) / max(area, 1e-37);
    float offset = min(1e-6 * (dot(abs(point), vec3(1.0)) + dot(abs(p), vec3(1.0))), 0.5 * abs(height));
    point += normal_area * (sign(height) * offset / max(area, 1e-37));
    bool emits = range.probability * chosen.probability > 0.0 && projected > 0.0;
    return LightSample(point, to / distance, emits ? 1.0 : 0.0, max(pdf, 1e-37));
}

// The nearest triangle that emits along a ray: its row, and the distance; -1: none.
struct EmitterHit { int row; float distance; };

EmitterHit emissive_mesh_hit(Light light, vec3 p, vec3 wi) {
    bool enclosed = emissive_mesh_encloses(light, p);
    EmitterHit nearest = EmitterHit(-1, 1e30);
    for (int k = light.first_triangle; k < light.first_triangle + light.triangle_count; ++k) {
        EmissiveTriangle triangle = fetch_EmissiveTriangle(scene_records, emissive_triangles + k);
        vec3 normal = cross(triangle.u, triangle.v), q = cross(wi, p - triangle.corner);
        float slope = dot(wi, normal), scale = slope == 0.0 ? 0.0 : 1.0 / slope;
        float s = dot(triangle.v, q) * scale, t = -dot(triangle.u, q) * scale;
        float distance = dot(triangle.corner - p, normal) * scale;
        bool hit = slope != 0.0 && min(s, t) >= 0.0 && s + t <= 1.0 && distance > 0.0;
        if (hit && distance < nearest.distance && emits_towards(triangle, p, enclosed))
            nearest = EmitterHit(k, distance);
    }
    return nearest;
}

// The density of samples on the nearest triangle.
float emissive_mesh_pdf(Light light, vec3 p, vec3 n, vec3 wi) {
    EmitterHit hit = emissive_mesh_hit(light, p, wi);
    if (hit.row < 0 || dot(n, wi) <= 0.0) return 0.0;
    bool enclosed = emissive_mesh_encloses(light, p);
    int first = light.first_triangle, count = light.triangle_count;
    float probability = 1.0;
    if (has_light_bvh(light)) {
        count /= light.leaves;
        int leaf = (hit.row - first) / count;
        first += leaf * count;
        for (int node = 1; node < light.leaves;) {
            int nodes = nodes_at_once(light, node);
            int next = (light.leaves + leaf) / (light.leaves >> findMSB(node * nodes));
            float sum = 0.0;
            for (int k = 0; k < nodes; ++k)
                sum += light_node_importance(light.first_node + node * nodes + k, p, n, enclosed);
            probability *= light_node_importance(light.first_node + next, p, n, enclosed) / max(sum, 1e-37);
            node = next;
        }
    }
    float sum = emissive_triangles_irradiance(first, count, p, n, enclosed);
    EmissiveTriangle triangle = fetch_EmissiveTriangle(scene_records, emissive_triangles + hit.row);
    probability *= emissive_triangle_irradiance(hit.row, p, n, enclosed) / max(sum, 1e-37);
    float fraction = triangle_sample(triangle.corner - p, triangle.u, triangle.v, n, vec2(0.5)).fraction;
    float projected = 0.5 * fraction * abs(dot(cross(triangle.u, triangle.v), wi));
    return probability * hit.distance * hit.distance / max(projected, 1e-37);
}

float emissive_mesh_emitted(Light light, vec3 p, vec3 wi) {
    return emissive_mesh_hit(light, p, wi).row < 0 ? 0.0 : 1.0;
}

float emissive_mesh_hit_distance(Light light, vec3 p, vec3 wi) { return emissive_mesh_hit(light, p, wi).distance; }

vec3 emissive_mesh_centre(Light light, vec3 p, vec3 to) { return light.position; }

float emissive_mesh_virtual_weight(Light light, vec3 v, vec3 n, vec3 axis) {
    float square = max(dot(v, v), 1e-30);
    return max(-dot(n, v), 0.0) * max(dot(axis, v), 0.0) / (square * square);
}
