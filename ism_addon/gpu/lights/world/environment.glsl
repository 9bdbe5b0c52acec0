// The world: light of a map's radiance, sampled by the product of that and the cosine (Clarberg et al. 2005; 2008), see
// gpu/environment/map_tables.py.
#include "maths/luminance.glsl"
#include "sampling/cosine_hemisphere.glsl"
#include "maths/equirectangular.glsl"
#include "maths/octahedron.glsl"

// Directions of the world and of the map: without rotation, the tables hold for all rotations.
vec3 to_map(vec3 wi) { return environment_rotation * wi; }
vec3 from_map(vec3 wi) { return wi * environment_rotation; }

// Of a mip level, interpolated linearly.
vec3 environment_radiance(vec3 wi, int level) {
    ivec2 size = max(environment_size >> level, ivec2(1));
    ivec2 corner = level == 0 ? ivec2(0) : ivec2(environment_size.x - (2 * environment_size.x >> level), environment_size.y);
    vec2 at = map_from_direction(to_map(wi)) * vec2(size) - 0.5, low = floor(at), part = at - low;
    int left = (int(low.x) + size.x) % size.x, right = (left + 1) % size.x;
    int below = max(int(low.y), 0), above = min(int(low.y) + 1, size.y - 1);
    vec3 lower = mix(texelFetch(environment_map, corner + ivec2(left, below), 0).rgb,
                     texelFetch(environment_map, corner + ivec2(right, below), 0).rgb, part.x);
    vec3 upper = mix(texelFetch(environment_map, corner + ivec2(left, above), 0).rgb,
                     texelFetch(environment_map, corner + ivec2(right, above), 0).rgb, part.x);
    return mix(lower, upper, part.y);
}

vec4 environment_texel(int index) { return uintBitsToFloat(texelFetch(scene_records, index)); }

// Nodes before those of a level, whose nodes are of 2^level by 2^level.
int nodes_before(int level) { return ((1 << 2 * level) - 1) / 3; }

// The first texel of a normal's nodes: one for each of COARSE_NODES.
int environment_nodes(vec3 n) {
    ivec2 cell = min(ivec2((0.5 * octahedron_from_direction(to_map(n)) + 0.5) * float(MAP_NORMALS)), MAP_NORMALS - 1);
    return environment_product + (cell.y * MAP_NORMALS + cell.x) * nodes_before(COARSE_LEVELS);
}

// The sums of a node's children: (0, 0), (1, 0), (0, 1) and (1, 1).
vec4 environment_children(int nodes, int level, ivec2 node) {
    int index = (node.y << level) + node.x + nodes_before(level);
    return environment_texel(level < COARSE_LEVELS ? nodes + index : environment_fine + index - nodes_before(COARSE_LEVELS));
}

// The density by solid angle where that of points of the square from 0 to 1 is 1.
float square_pdf(vec3 wi) {
    float size = abs(wi.x) + abs(wi.y) + abs(wi.z); // of the point of the octahedron, 1 / its distance
    return 0.25 / (size * size * size);
}

vec3 environment_irradiance_at(vec3 n) {
    vec2 at = (0.5 * octahedron_from_direction(to_map(n)) + 0.5) * float(IRRADIANCE_CELLS);
    ivec2 cell = min(ivec2(at), IRRADIANCE_CELLS - 1);
    vec2 part = at - vec2(cell);
    int first = environment_irradiance_table + cell.y * (IRRADIANCE_CELLS + 1) + cell.x;
    vec4 below = mix(environment_texel(first), environment_texel(first + 1), part.x);
    int next = first + IRRADIANCE_CELLS + 1;
    return mix(below, mix(environment_texel(next), environment_texel(next + 1), part.x), part.y).rgb;
}

float environment_irradiance(Light light, vec3 p, vec3 n) { return luminance(environment_irradiance_at(n)); }

// Where a ray has left the scene.
vec3 environment_point(vec3 p, vec3 wi) { return p + 2.0 * scene_extent.x * wi; }

// A direction by the product of the map and the cosine, and its density.
vec4 environment_direction(vec3 n, vec2 uv) {
    int nodes = environment_nodes(n);
    ivec2 node = ivec2(0);
    float probability = 1.0;
    for (int level = 0; level < ALL_LEVELS; ++level) {
        vec4 children = environment_children(nodes, level, node);
        vec2 columns = children.xy + children.zw;
        float sum = columns.x + columns.y, left = columns.x / sum;
        bool right = uv.x >= left;
        uv.x = right ? (uv.x - left) / max(1.0 - left, 1e-30) : uv.x / left;
        vec2 rows = right ? children.yw : children.xz;
        float below = rows.x / (rows.x + rows.y);
        bool above = uv.y >= below;
        uv.y = above ? (uv.y - below) / max(1.0 - below, 1e-30) : uv.y / below;
        probability *= (above ? rows.y : rows.x) / sum;
        node = 2 * node + ivec2(right, above);
    }
    float side = float(1 << ALL_LEVELS);
    vec3 wi = direction_from_octahedron(2.0 * (vec2(node) + clamp(uv, 0.0, 1.0)) / side - 1.0);
    return vec4(from_map(wi), probability * side * side * square_pdf(wi));
}

float sum_of(vec4 v) { return v.x + v.y + v.z + v.w; }

// A node's own sum, among its parent's children.
float environment_node(int nodes, int level, ivec2 node) {
    return environment_children(nodes, level - 1, node >> 1)[(node.x & 1) + 2 * (node.y & 1)];
}

// Of these, and so of samples that go through no portal.
float environment_pdf_beside(vec3 n, vec3 wi) {
    if (dot(n, wi) <= 0.0) return 0.0;
    int nodes = environment_nodes(n);
    float side = float(1 << ALL_LEVELS);
    vec3 in_map = to_map(wi);
    ivec2 cell = min(ivec2((0.5 * octahedron_from_direction(in_map) + 0.5) * side), (1 << ALL_LEVELS) - 1);
    ivec2 coarse = cell >> (ALL_LEVELS - COARSE_LEVELS);
    float probability = environment_node(nodes, COARSE_LEVELS, coarse) / sum_of(environment_children(nodes, 0, ivec2(0)));
    probability *= environment_node(nodes, ALL_LEVELS, cell) / sum_of(environment_children(nodes, COARSE_LEVELS, coarse));
    return probability * side * side * square_pdf(in_map);
}

#if PORTALS == ENVIRONMENT
#include "lights/portals.glsl"

float environment_pdf(Light light, vec3 p, vec3 n, vec3 wi) {
    return portals_pdf(portal_weights(p, n), p, n, wi, environment_pdf_beside(n, wi));
}

LightSample environment_sample(Light light, vec3 p, vec3 n, vec2 uv) {
    PortalWeights weights = portal_weights(p, n);
    bool through = goes_through(weights, uv);
    vec3 wi = through ? sample_portals(weights, p, n, uv) : environment_direction(n, uv).xyz;
    float pdf = portals_pdf(weights, p, n, wi, environment_pdf_beside(n, wi));
    float radiance = pdf > 0.0 ? luminance(environment_radiance(wi, 0)) : 0.0; // rounded below the horizon
    return LightSample(environment_point(p, wi), wi, radiance, max(pdf, 1e-37), -1);
}
#else
float environment_pdf(Light light, vec3 p, vec3 n, vec3 wi) { return environment_pdf_beside(n, wi); }

LightSample environment_sample(Light light, vec3 p, vec3 n, vec2 uv) {
    vec4 chosen = environment_direction(n, uv);
    float radiance = luminance(environment_radiance(chosen.xyz, 0));
    return LightSample(environment_point(p, chosen.xyz), chosen.xyz, radiance, max(chosen.w, 1e-37), -1);
}
#endif

float environment_emitted(Light light, vec3 p, vec3 wi) { return luminance(environment_radiance(wi, 0)); }

// The color of the light from a direction, over its luminance.
vec3 environment_color(vec3 wi) {
    vec3 radiance = environment_radiance(wi, 0);
    return radiance / max(luminance(radiance), 1e-30);
}

// Virtual lights are directions.
float environment_virtual_weight(Light light, vec3 v, vec3 n, vec3 axis) { return 4.0 * max(-dot(n, axis), 0.0); }

vec3 environment_centre(Light light, vec3 p, vec3 to) { return to; }

// Behind all surfaces, before the background.
float environment_hit_distance(Light light, vec3 p, vec3 wi) { return 1e29; }
