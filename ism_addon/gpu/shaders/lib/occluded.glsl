// Whether anything stands between two points, by the trees of boxes of tree.py: one over the instances, in whose leaves
// one over the triangles of a mesh begins. Without a stack: a bit for each level says whether the other child waits
// (Barringer & Akenine-Möller 2013, for complete trees). Boxes, meshes and triangles have loops of their own
// (Aila & Laine 2009), which also lets those processors skip them that walk through both sides of every "if".
uniform sampler2D tree_nodes;
uniform sampler2D tree_triangles;
uniform sampler2D casters;
uniform int caster_leaves;

// Where a ray is among the boxes of one tree: the node, and for each level whether its sibling waits. Node 0: nowhere.
struct Place { int node; uint trail; };

ivec2 tree_texel(int i) { return ivec2(i & (WIDTH - 1), i / WIDTH); }

Place next_place(Place here) {
    int levels = findLSB(here.trail);
    return here.trail == 0u ? Place(0, 0u) : Place((here.node >> levels) ^ 1, (here.trail >> levels) & ~1u);
}

vec3 without_zero(vec3 v) { return mix(v, vec3(1e-20), lessThan(abs(v), vec3(1e-20))); }

// Where the ray, 0 to 1, enters a box, or 2 if it misses it. A rounding error may not lose it.
float entry(vec3 low, vec3 high, vec3 origin, vec3 inverse_ray) {
    vec3 a = (low - origin) * inverse_ray, b = (high - origin) * inverse_ray;
    vec3 enter = min(a, b), leave = max(a, b);
    float near = max(max(enter.x, enter.y), max(enter.z, 0.0));
    float far = min(min(leave.x, leave.y), min(leave.z, 1.0));
    return near <= far * 1.000001 ? near : 2.0;
}

// On to the nearer child that the ray meets, or to what waits.
Place descend(int first_node, Place here, vec3 origin, vec3 inverse_ray) {
    int texel = 3 * (first_node + here.node);
    vec4 x = texelFetch(tree_nodes, tree_texel(texel), 0);
    vec4 y = texelFetch(tree_nodes, tree_texel(texel + 1), 0);
    vec4 z = texelFetch(tree_nodes, tree_texel(texel + 2), 0);
    float one = entry(x.xyz, vec3(x.w, y.xy), origin, inverse_ray);
    float other = entry(vec3(y.zw, z.x), z.yzw, origin, inverse_ray);
    Place child = Place(2 * here.node + (other < one ? 1 : 0), 2u * here.trail + (max(one, other) < 2.0 ? 1u : 0u));
    return min(one, other) < 2.0 ? child : next_place(here);
}

bool crosses(int triangle, vec3 origin, vec3 ray, float own) {
    vec4 a = texelFetch(tree_triangles, tree_texel(3 * triangle), 0);
    vec3 u = texelFetch(tree_triangles, tree_texel(3 * triangle + 1), 0).xyz;
    vec3 v = texelFetch(tree_triangles, tree_texel(3 * triangle + 2), 0).xyz;
    vec3 p = cross(ray, v), to = origin - a.xyz, q = cross(to, u); // Möller & Trumbore 1997
    float scale = 1.0 / dot(u, p);
    float s = dot(to, p) * scale, t = dot(ray, q) * scale, at = dot(v, q) * scale;
    return s >= 0.0 && t >= 0.0 && s + t <= 1.0 && at > 0.0 && at < 1.0 && a.w != own;
}

// The triangle of an instance on which the ray starts cannot be in its own way.
bool occluded(vec3 from, vec3 to, int triangle, int instance) {
    vec3 whole_ray = without_zero(to - from), whole_inverse = 1.0 / whole_ray;
    Place outside = Place(1, 0u);
    bool hit = false;
    while (outside.node > 0) {
        while (outside.node > 0 && outside.node < caster_leaves) outside = descend(0, outside, from, whole_inverse);
        if (outside.node == 0) break;
        Caster caster = fetch_Caster(casters, outside.node - caster_leaves);
        mat4x3 inside = transpose(mat3x4(caster.row0, caster.row1, caster.row2));
        vec3 origin = inside * vec4(from, 1.0), ray = without_zero(inside * vec4(whole_ray, 0.0)), inverse_ray = 1.0 / ray;
        float own = caster.instance == instance ? float(triangle - caster.first_own) : -1.0;
        Place here = Place(1, 0u);
        while (here.node > 0) {
            while (here.node > 0 && here.node < caster.leaves) here = descend(caster.first_node, here, origin, inverse_ray);
            int first = caster.first_triangle + (here.node - caster.leaves) * caster.per_leaf;
            int last = here.node > 0 ? first + caster.per_leaf : first;
            for (int k = first; k < last; ++k) hit = hit || crosses(k, origin, ray, own);
            here = hit ? Place(0, 0u) : next_place(here);
        }
        outside = hit ? Place(0, 0u) : next_place(outside);
    }
    return hit;
}
