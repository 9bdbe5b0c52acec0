// Emissive meshes whose triangles have a uniform radiance each. Few triangles have a closed form together, and one is
// chosen for a sample by its irradiance. More have a light BVH: their irradiance is estimated from its root, which the
// irradiance cache corrects, and a triangle is chosen by importance, from node to node.
#include "lights/emissive_limits.glsl"
#include "closed_forms/triangle.glsl"
#include "lights/light_node.glsl"
#include "sampling/discrete.glsl"
#include "sampling/triangle.glsl"
#ifndef MESHES_WITH_BVH
#define MESHES_WITH_BVH 1
#endif
#ifndef MESHES_WITHOUT_BVH
#define MESHES_WITHOUT_BVH 1
#endif
#ifndef MESH_COLORS
#define MESH_COLORS 0 // 1: triangles of a mesh differ in radiance, and there are tables of that
#endif
#ifndef ESTIMATE_NODES
#define ESTIMATE_NODES MAX_NODES // see estimate_light_bvh
#endif
const int MAX_NODES = 16, CACHED_NODES = MESH_COLORS == 1 ? 16 : 1;

// Of a triangle, relative to the light's emission: a colour of luminance 1, and the luminance.
EmissiveColor emissive_color(int row) {
#if MESH_COLORS
    return fetch_EmissiveColor(scene_records, emissive_colors + row);
#else
    return EmissiveColor(vec3(1.0), 1.0);
#endif
}

// The mean colour of a node's triangles.
vec3 light_node_color(int row) {
#if MESH_COLORS
    return fetch_LightNodeColor(scene_records, light_node_colors + row).color;
#else
    return vec3(1.0);
#endif
}

// The largest relative luminance of a triangle.
float brightest(Light light) {
#if MESH_COLORS
    return light.brightest;
#else
    return 1.0;
#endif
}

// Irradiance, and in yzw the same times its colour.
vec4 colored(float irradiance, vec3 color) { return vec4(irradiance, irradiance * color); }

vec3 mean_color(vec4 irradiance) { return MESH_COLORS == 1 ? irradiance.yzw / max(irradiance.x, 1e-37) : vec3(1.0); }

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
    return triangle_irradiance(triangle.corner - p, triangle.u, triangle.v, n, SMALL_TRIANGLE) *
           emissive_color(row).luminance;
}

float light_node_importance(int row, vec3 p, vec3 n, bool enclosed) {
    return estimate_node(fetch_LightNode(scene_records, light_nodes + row), p, n, enclosed).y;
}

vec4 emissive_triangles_irradiance(int first, int count, vec3 p, vec3 n, bool enclosed) {
    vec4 sum = vec4(0.0);
    for (int k = first; k < first + count; ++k)
        sum += colored(emissive_triangle_irradiance(k, p, n, enclosed), emissive_color(k).color);
    return sum;
}

// Estimated irradiance of a light BVH: the sum over `nodes` nodes, all of one depth, from the root at 1 to MAX_NODES.
vec4 estimate_light_bvh(Light light, vec3 p, vec3 n, int nodes) {
    bool enclosed = emissive_mesh_encloses(light, p);
    vec4 sum = vec4(0.0);
    for (int node = nodes; node < 2 * nodes; ++node) {
        int row = light.first_node + node;
        LightNode bounds = fetch_LightNode(scene_records, light_nodes + row);
        sum += colored(estimate_node(bounds, p, n, enclosed).x, light_node_color(row));
    }
    return colored(min(sum.x, 3.141592653589793 * brightest(light)), mean_color(sum));
}

vec4 emissive_mesh_colored_irradiance(Light light, vec3 p, vec3 n) {
    if (has_light_bvh(light)) return estimate_light_bvh(light, p, n, ESTIMATE_NODES);
    bool enclosed = emissive_mesh_encloses(light, p);
    return emissive_triangles_irradiance(light.first_triangle, light.triangle_count, p, n, enclosed);
}

float emissive_mesh_irradiance(Light light, vec3 p, vec3 n) { return emissive_mesh_colored_irradiance(light, p, n).x; }

// The same without the estimate's error: by nodes that face the receiver and are seen as smaller than MAX_NODE_SIZE, and
// by the triangles of other leaves. These have separate loops, which drivers that execute both branches of an "if" can
// skip.
const float MAX_NODE_SIZE = MESH_COLORS == 1 ? 0.05 : 0.15;
const float MAX_EDGE_NODE_SIZE = 0.05, MAX_HORIZON_NODE_SIZE = 0.0015; // radius over distance
const float MAX_EDGE_NODE_SLACK = 0.2;

vec4 emissive_mesh_accurate_irradiance(Light light, vec3 p, vec3 n) {
    bool enclosed = emissive_mesh_encloses(light, p);
    int per_leaf = light.triangle_count / light.leaves, node = 1;
    vec4 sum = vec4(0.0);
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
            bool is_estimated = !is_hidden && (is_small || is_tiny);
            sum += colored(is_estimated ? irradiance : 0.0, light_node_color(light.first_node + node));
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
    int row = range.first + chosen.index;
    return LightSample(point, to / distance, emits ? emissive_color(row).luminance : 0.0, max(pdf, 1e-37), row);
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
    float sum = emissive_triangles_irradiance(first, count, p, n, enclosed).x;
    EmissiveTriangle triangle = fetch_EmissiveTriangle(scene_records, emissive_triangles + hit.row);
    probability *= emissive_triangle_irradiance(hit.row, p, n, enclosed) / max(sum, 1e-37);
    float fraction = triangle_sample(triangle.corner - p, triangle.u, triangle.v, n, vec2(0.5)).fraction;
    float projected = 0.5 * fraction * abs(dot(cross(triangle.u, triangle.v), wi));
    return probability * hit.distance * hit.distance / max(projected, 1e-37);
}

float emissive_mesh_emitted(Light light, vec3 p, vec3 wi) {
    int row = emissive_mesh_hit(light, p, wi).row;
    return row < 0 ? 0.0 : emissive_color(row).luminance;
}

float emissive_mesh_hit_distance(Light light, vec3 p, vec3 wi) { return emissive_mesh_hit(light, p, wi).distance; }

vec3 emissive_mesh_centre(Light light, vec3 p, vec3 to) { return light.position; }

float emissive_mesh_virtual_weight(Light light, vec3 v, vec3 n, vec3 axis) {
    float square = max(dot(v, v), 1e-30);
    return max(-dot(n, v), 0.0) * max(dot(axis, v), 0.0) / (square * square);
}
