// Traversal of the bounding volume hierarchies of accel/bvh.py: a TLAS over instances, and a BLAS over each mesh's
// triangles. Four boxes are tested together, as fetching them takes most of the time. There is no stack: four bits per
// level say which boxes are still to be visited (Barringer & Akenine-Moller 2013, for complete trees). Boxes, meshes
// and triangles have separate loops (Aila & Laine 2009), which processors that execute both branches of an "if" can
// skip. A ray leaves them for each triangle that it hits: what passes through the triangle is then evaluated for all rays
// that are executed together, and not while most of them wait.
#include "trace/triangle_fetch.glsl"
#include "surfaces/light_linking.glsl"
#include "textures/scene_records.glsl"
#if TRANSPARENCY
#include "surfaces/transparency.glsl"
#include "maths/random_bits.glsl"
uniform int transparent_hits; // with more, a shadow ray is occluded
#endif
uniform usamplerBuffer blas_nodes; // and after them the first triangles of leaves, four a texel
uniform int tlas_nodes; // rows of BVH_NODE
uniform int casters;    // rows of CASTER
uniform int tlas_leaves;
uniform vec3 tlas_centre;
uniform vec3 tlas_scale;

// State of a ray's traversal of one BVH: the node, and which of its siblings and of its ancestors' siblings are still
// to be visited, four bits per level, the lowest eight levels in x. Node 0: the traversal has ended.
struct TraversalState { int node; uvec2 trail; };

TraversalState pop(TraversalState state) {
    if (state.trail.x == 0u) state = TraversalState(state.node >> 16, uvec2(state.trail.y, 0u));
    int pending = findLSB(state.trail.x), up = pending & ~3;
    uvec2 trail = uvec2(state.trail.x >> up | state.trail.y << 1 << (31 - up), state.trail.y >> up);
    int node = (state.node >> (up >> 1) & ~3) | (pending & 3);
    return state.trail.x == 0u ? TraversalState(0, uvec2(0u))
                               : TraversalState(node, uvec2(trail.x & (trail.x - 1u), trail.y));
}

vec3 avoid_zero(vec3 v) { return mix(v, vec3(1e-20), lessThan(abs(v), vec3(1e-20))); }

vec4 unpack_bytes(uint word) { return vec4(uvec4(word) >> uvec4(0, 8, 16, 24) & 255u); }

// Goes to the first of the node's four grandchildren that the ray hits, or to the nearest of them, or else to the next
// node to visit. Boxes are enlarged by BOX_SLACK for rounding errors. The ray ends at the fraction `end` of its length.
TraversalState next_leaf(usamplerBuffer nodes, int first_node, TraversalState state, vec3 origin, vec3 inverse_ray,
                         float end, bool nearest_first) {
    int at = 2 * (first_node + state.node);
    uvec4 one = texelFetch(nodes, at), other = texelFetch(nodes, at + 1);
    vec3 begin = vec3(ivec3(uvec3(one.x << 16, one.x, one.y << 16) & 0xffff0000u) >> 7);
    vec3 unit = vec3(uvec3(512u) << (uvec3(one.y) >> uvec3(16, 20, 24) & 15u));
    vec3 first = (begin - origin) * inverse_ray, step = unit * inverse_ray;
    uvec3 low = uvec3(one.zw, other.x), high = other.yzw;
    ivec4 enter_bits = ivec4(0), leave_bits = ivec4(floatBitsToInt(end)); // ordered like the numbers if one is positive
    for (int k = 0; k < 3; ++k) {
        bool back = inverse_ray[k] < 0.0;
        enter_bits = max(enter_bits, floatBitsToInt(unpack_bytes(back ? high[k] : low[k]) * step[k] + first[k]));
        leave_bits = min(leave_bits, floatBitsToInt(unpack_bytes(back ? low[k] : high[k]) * step[k] + first[k]));
    }
    vec4 enter = intBitsToFloat(enter_bits), leave = intBitsToFloat(leave_bits);
    uvec4 bits = uvec4(lessThanEqual(enter, leave * 1.000001)) << uvec4(0, 1, 2, 3);
    uint hits = bits.x | bits.y | bits.z | bits.w;
    int next = findLSB(hits);
    if (nearest_first) {
        vec4 distances = mix(vec4(2.0), enter, notEqual(bits, uvec4(0u)));
        vec2 low = min(distances.xz, distances.yw);
        next = low.x <= low.y ? int(distances.y < distances.x) : 2 + int(distances.w < distances.z);
    }
    uvec2 trail = uvec2(state.trail.x << 4 | (hits & ~(1u << next)), state.trail.y << 4 | state.trail.x >> 28);
    return hits > 0u ? TraversalState(4 * state.node + next, trail) : pop(state);
}

// The side of a ray from the origin on which it passes the edge from a to b. The same edge of a neighbour, from b to a,
// gives exactly the opposite, so that no ray passes between two triangles: fused operations would round differently.
float edge_side(vec3 ray, vec3 a_plus_b, vec3 edge) {
    precise vec3 moment = a_plus_b.yzx * edge.zxy - a_plus_b.zxy * edge.yzx;
    precise float side = ray.x * moment.x + ray.y * moment.y + ray.z * moment.z;
    return side;
}

// Fraction of the ray's length at which it hits the triangle, or more than 1.
float triangle_distance(int triangle, vec3 origin, vec3 ray) {
    TriangleVertices corners = fetch_triangle(triangle);
    vec3 a = corners.first - origin, b = corners.first + corners.u - origin, c = corners.first + corners.v - origin;
    vec3 side = vec3(edge_side(ray, a + b, corners.u), edge_side(ray, b + c, corners.v - corners.u),
                     edge_side(ray, c + a, -corners.v));
    vec3 normal = cross(corners.u, corners.v);
    float height = dot(normal, a), slope = dot(normal, ray); // it meets the plane at height / slope of its length
    bool inside = all(greaterThanEqual(side, vec3(0.0))) || all(lessThanEqual(side, vec3(0.0)));
    return inside && height * slope > 0.0 ? height / slope : 2.0;
}

struct Intersection { float distance; int triangle; int instance; }; // a fraction of the ray's length, 1 if there is none

#if TRANSPARENCY
// What passes through a triangle where a ray meets it. `blas_from_anchor`: linear; `on_mesh`: in its space.
vec3 transparency_at(Intersection hit, mat3 blas_from_anchor, vec3 position, vec3 anchor_ray, vec3 on_mesh) {
    TriangleVertices corners = fetch_triangle(hit.triangle);
    vec3 n = cross(corners.u, corners.v), scaled = n / dot(n, n), in_triangle = on_mesh - corners.first;
    float s = dot(cross(in_triangle, corners.v), scaled), t = dot(cross(corners.u, in_triangle), scaled);
    vec3 normal = normalize(n * blas_from_anchor), incoming = -normalize(anchor_ray);
    // A mirrored instance flips its triangles, and by that matrix also their normals.
    bool is_back = dot(normal, incoming) < 0.0;
    if (is_back) normal = -normal;
    vec3 barycentric = vec3(1.0 - s - t, s, t);
    ShadingPoint at =
        ShadingPoint(position, barycentric, normal, normal, incoming, is_back, hit.triangle, hit.instance);
    return transparency(corners.material, at).rgb;
}
#endif

// For `blockers`: what the camera sees, or all that casts shadows.
const int CAMERA = -2, CASTERS = -1;

// The nearest intersection of the segment with the instances of the group `blockers`; if `any_is_enough`, one of them.
// The triangle of the instance where it starts is ignored. Shadow rays, for which any intersection is enough, pass
// transparent surfaces; `passed` is the light's fraction that does. Others to CASTERS meet them with that probability.
Intersection traverse(vec3 from, vec3 to, int triangle, int instance, int blockers, bool any_is_enough,
                      inout vec3 passed) {
#if TRANSPARENCY
    int hits = 0;
#endif
    vec3 anchor_ray = avoid_zero(to - from), tlas_inverse_ray = 1.0 / (anchor_ray * tlas_scale);
    vec3 tlas_origin = (from - tlas_centre) * tlas_scale;
    TraversalState outer = TraversalState(1, uvec2(0u));
    Intersection nearest = Intersection(1.0, -1, -1);
    while (outer.node > 0) {
        float end = any_is_enough ? 1.0 : nearest.distance;
        while (outer.node > 0 && outer.node < tlas_leaves)
            outer = next_leaf(scene_records, tlas_nodes, outer, tlas_origin, tlas_inverse_ray, end, !any_is_enough);
        if (outer.node == 0) break;
        Caster caster = fetch_Caster(scene_records, casters + outer.node - tlas_leaves);
        mat4x3 blas_from_anchor = transpose(mat3x4(caster.row0, caster.row1, caster.row2));
        vec3 origin = blas_from_anchor * vec4(from, 1.0);
        vec3 ray = avoid_zero(blas_from_anchor * vec4(anchor_ray, 0.0)), inverse_ray = 1.0 / ray;
        int ignored = caster.instance == instance ? triangle : -1;
        bool is_seen = is_linked(caster.link_groups, blockers) && (blockers != CAMERA || caster.instance >= 0);
        TraversalState state = TraversalState(is_seen ? 1 : 0, uvec2(0u));
        int next = 0, last = 0; // triangles of a leaf
        while (state.node > 0 || next < last) {
            Intersection hit = Intersection(2.0, -1, caster.instance);
            while (hit.triangle < 0 && (state.node > 0 || next < last)) {
                while (next == last && state.node > 0 && state.node < caster.leaves)
                    state = next_leaf(blas_nodes, caster.first_node, state, origin, inverse_ray, end, !any_is_enough);
                if (next == last && state.node > 0) {
                    int start = caster.first_leaf + state.node - caster.leaves;
                    next = caster.first_triangle + int(texelFetch(blas_nodes, start >> 2)[start & 3]);
                    last = next + caster.triangles_per_leaf;
                    state = pop(state);
                }
                for (; next < last && hit.triangle < 0; ++next) {
                    hit.distance = triangle_distance(next, origin, ray);
                    if (hit.distance < end && next != ignored) hit.triangle = next;
                }
            }
            if (hit.triangle < 0) break;
#if TRANSPARENCY
            if (any_is_enough && has_transparency(fetch_triangle(hit.triangle).material)) {
                vec3 position = mix(from, to, hit.distance), on_mesh = origin + hit.distance * ray;
                passed *= transparency_at(hit, mat3(blas_from_anchor), position, anchor_ray, on_mesh);
                ++hits;
                if (hits <= transparent_hits && passed != vec3(0.0)) continue;
            }
#endif
#if TRANSPARENCY
            if (!any_is_enough && blockers == CASTERS && has_transparency(fetch_triangle(hit.triangle).material)) {
                vec3 position = mix(from, to, hit.distance), on_mesh = origin + hit.distance * ray;
                vec3 passes = transparency_at(hit, mat3(blas_from_anchor), position, anchor_ray, on_mesh);
                uint random = random_bits(floatBitsToUint(to), uint(hit.triangle)).x ^ uint(hit.instance) * 0x9e3779b9u;
                if (dot(passes, vec3(1.0 / 3.0)) > float(random >> 8) / 16777216.0) continue;
            }
#endif
            nearest = hit;
            end = nearest.distance;
            if (any_is_enough) break;
        }
        outer = any_is_enough && nearest.triangle >= 0 ? TraversalState(0, uvec2(0u)) : pop(outer);
    }
    return nearest;
}

// The fraction of light that the instances of the group `blockers` let pass along the segment. The triangle where it
// starts is ignored.
vec3 transmittance(vec3 from, vec3 to, int triangle, int instance, int blockers) {
    vec3 passed = vec3(1.0);
    return traverse(from, to, triangle, instance, blockers, true, passed).triangle >= 0 ? vec3(0.0) : passed;
}

// The nearest intersection with what the camera sees. The triangle where the segment starts is ignored.
Intersection nearest_hit(vec3 from, vec3 to, int triangle, int instance) {
    vec3 passed = vec3(1.0);
    return traverse(from, to, triangle, instance, CAMERA, false, passed);
}

// The fraction of the segment's length to the nearest intersection with what casts shadows, 1 if there is none.
float occluder_distance(vec3 from, vec3 to, int triangle, int instance) {
    vec3 passed = vec3(1.0);
    return traverse(from, to, triangle, instance, CASTERS, false, passed).distance;
}
