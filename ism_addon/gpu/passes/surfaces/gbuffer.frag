// The surface of a pixel, from its triangle's index.
#include "trace/triangle_fetch.glsl"
#include "maths/octahedron.glsl"
#include "maths/packed_normal.glsl"
#include "surfaces/camera_ray.glsl"
#include "surfaces/instances.glsl"
#include "surfaces/terminator_offset.glsl"
#include "surfaces/visible_triangle.glsl"
#include "sampling/sample_index.glsl"
#if GLOSS
#include "materials/gloss_packing.glsl"
#endif
#if IMAGES
#include "textures/image.glsl"
#endif
#if IMAGES || GRAPH
#include "nodes/point.glsl"
#endif
#if GRAPH
#include "surfaces/node_graph.glsl"
#endif
#if GLOSSY
#include "nodes/gloss.glsl"
#endif

uniform usamplerBuffer materials;
uniform isamplerBuffer corner_normal_buffer;
#ifdef GRAPH_CELLS
uniform int own_graph;        // of the materials that this program draws
uniform int background_graph; // of the program that draws the background too
#endif
#if LAYERS // a second draw for lobes that few scenes have: framebuffers have at most eight targets
float depth;
vec4 position, base_color;
uvec4 normal;
#if COAT
layout(location = 0) out uvec4 coat;
#endif
#if RARE_LOBES
layout(location = RARE_LOCATION) out uvec4 rare_lobes;
#endif
#else
layout(location = 0) out float depth;
layout(location = 1) out vec4 position;
layout(location = 2) out uvec4 normal; // see surfaces/surface.glsl
layout(location = 3) out vec4 base_color;
#if GLOSS
layout(location = 4) out uvec4 gloss_reflectance;
layout(location = 5) out uvec4 gloss_rise;
layout(location = 6) out uvec4 ltc_entries;
#endif
#endif

const float MIN_BUMP = 1e-4; // change of the normal
const float MAX_RELATIVE_SIZE = 100.0; // a triangle's size over its distance

// Barycentric coordinates of a ray's intersection with the plane of the triangle a, a + u, a + v, whose normal is n.
vec3 barycentric(Ray ray, vec3 a, vec3 u, vec3 v, vec3 n) {
    vec3 q = cross(ray.direction, ray.origin - a);
    float scale = 1.0 / dot(ray.direction, n);
    float s = dot(v, q) * scale, t = -dot(u, q) * scale;
    return vec3(1.0 - s - t, s, t);
}

// Barycentric coordinates of the point on the triangle's edges that is nearest to a ray which misses the triangle.
// Clamped coordinates could be far from it, along a long and thin triangle.
vec3 nearest_edge_barycentric(Ray ray, vec3 a, vec3 u, vec3 v) {
    vec3 corners[3] = vec3[3](a, a + u, a + v), direction = normalize(ray.direction), nearest = vec3(1.0, 0.0, 0.0);
    float min_square = 1e38;
    for (int k = 0; k < 3; ++k) {
        vec3 start = corners[k] - ray.origin, edge = corners[(k + 1) % 3] - corners[k];
        // Projected onto the plane perpendicular to the ray.
        vec3 projected_start = start - direction * dot(start, direction);
        vec3 projected_edge = edge - direction * dot(edge, direction);
        float square_length = max(dot(projected_edge, projected_edge), 1e-38);
        float t = clamp(-dot(projected_start, projected_edge) / square_length, 0.0, 1.0);
        vec3 offset = projected_start + t * projected_edge;
        float square = dot(offset, offset);
        vec3 b = vec3(0.0);
        b[k] = 1.0 - t;
        b[(k + 1) % 3] = t;
        if (square < min_square) nearest = b;
        min_square = min(min_square, square);
    }
    return nearest;
}

#if GRAPH
// A unit vector at right angles to another, as Cycles chooses it: differences of bumps are taken along it.
vec3 orthogonal(vec3 n) {
    return normalize(n.x != n.y || n.x != n.z ? cross(vec3(1.0), n) : cross(vec3(-1.0, 1.0, 1.0), n));
}

// Of a pixel at a distance from the camera. The mean of both sides.
float pixel_size(Ray ray, vec2 pixel, float distance) {
    Ray x = view_ray(pixel + vec2(1.0, 0.0)), y = view_ray(pixel + vec2(0.0, 1.0));
    vec3 direction = normalize(ray.direction);
    float angles = length(normalize(x.direction) - direction) + length(normalize(y.direction) - direction);
    return 0.5 * (length(x.origin - ray.origin) + length(y.origin - ray.origin) + distance * angles);
}

// Barycentric coordinates of a way along the plane of u and v.
vec3 in_plane(vec3 way, vec3 u, vec3 v) {
    vec3 n = cross(u, v), scaled = n / dot(n, n);
    float s = dot(cross(way, v), scaled), t = dot(cross(u, way), scaled);
    return vec3(-s - t, s, t);
}

Shift shift(vec3 barycentric, vec3 u, vec3 v) { return Shift(u * barycentric.y + v * barycentric.z, barycentric); }
#endif

void clear_lobes() {
#if LAYERS && COAT
    coat = uvec4(0u);
#endif
#if LAYERS && RARE_LOBES
    rare_lobes = pack_rare_lobes(RareLobes(vec3(0.0), vec2(0.0), 1.0, 0.0, 0.0, 0.0, false));
#endif
#if !LAYERS && GLOSS
    gloss_reflectance = gloss_rise = ltc_entries = uvec4(0u);
#endif
}

#if GLOSSY
// Of a lobe's normal and the direction to the camera. Corrected bumps of glossy lobes face it, unlike their mean with
// others.
float view_cosine(Closures closures, vec3 wo, vec3 n) {
    return closures.shadows_bumps ? max(dot(wo, n), 1e-6) : dot(wo, n);
}

// `bumps`: see pack_rise.
void write_lobes(Closures closures, vec3 wo, vec3 n, uint bumps) {
    Gloss gloss = gloss_of(closures.glossy, view_cosine(closures, wo, n)), coat_gloss = gloss;
    vec3 coat_normal = n;
#if COAT
    if (closures.coat_normal != vec3(0.0)) coat_normal = normalize(closures.coat_normal);
    coat_gloss = gloss_of(closures.coat, view_cosine(closures, wo, coat_normal));
#endif
#if LAYERS && COAT
    coat = pack_coat(Coat(coat_gloss, coat_normal));
#endif
#if LAYERS && RARE_LOBES
    rare_lobes = pack_rare_lobes(rare_lobes_of(closures, n));
#endif
#if !LAYERS
    gloss_reflectance = pack_reflectance(gloss);
    gloss_rise = pack_rise(gloss, bumps);
    ltc_entries = uvec4(pack_ltc(gloss.ltc), pack_ltc(coat_gloss.ltc));
#endif
}
#endif

void main() {
    vec2 pixel = gl_FragCoord.xy + visibility_texel_and_offset.zw;
    uvec2 id = visible_triangle(floor(gl_FragCoord.xy));
    clear_lobes();
    TriangleVertices corner = fetch_triangle(max(int(id.x) - 1, 0));
#ifdef GRAPH_CELLS
    int graph = id.x == 0u ? background_graph : fetch_Material(materials, corner.material).graph;
    if (graph != own_graph) discard; // another program draws it
#endif
    if (id.x == 0u) {
        depth = BACKGROUND_DEPTH;
        position = base_color = vec4(0.0);
        normal = uvec4(0u);
        return;
    }
    int triangle = int(id.x) - 1;
    Instance instance = instance_at(int(id.y));
    mat3 linear = transpose(mat3(instance.row0.xyz, instance.row1.xyz, instance.row2.xyz));
    vec3 offset = vec3(instance.row0.w, instance.row1.w, instance.row2.w);

    vec3 a = linear * corner.first + offset, u = linear * corner.u, v = linear * corner.v;
    vec3 geometric_normal = cross(u, v);

    Ray ray = view_ray(pixel);
    vec3 exact = barycentric(ray, a, u, v, geometric_normal);
    vec3 b = all(greaterThanEqual(exact, vec3(0.0))) ? exact : nearest_edge_barycentric(ray, a, u, v);
    vec3 p = a + u * b.y + v * b.z, to_p = p - ray.origin;
    // On a very large triangle barycentric coordinates are too coarse, but its plane is precise.
    if (max(dot(u, u), dot(v, v)) > MAX_RELATIVE_SIZE * MAX_RELATIVE_SIZE * dot(to_p, to_p))
        p = ray.origin + ray.direction * (dot(to_p, geometric_normal) / dot(ray.direction, geometric_normal));
    depth = -(view_from_anchor * vec4(p, 1.0)).z;

    // Normals are transformed by the cofactor matrix. A mirrored instance flips them, as it flips its triangles.
    linear /= max(max(length(linear[0]), length(linear[1])), length(linear[2])); // quanta are small units
    mat3 cofactor = mat3(cross(linear[1], linear[2]), cross(linear[2], linear[0]), cross(linear[0], linear[1]));
    vec3 smooth_normal = vec3(0.0);
    vec3 corner_normals[3];
    for (int k = 0; k < 3; ++k) {
        vec2 octahedra = vec2(texelFetch(corner_normal_buffer, 3 * triangle + k).xy) / OCTAHEDRON_STEPS;
        corner_normals[k] = direction_from_octahedron(octahedra);
        smooth_normal += b[k] * corner_normals[k];
    }
    smooth_normal = normalize(cofactor * smooth_normal);
    geometric_normal = normalize(geometric_normal);
    float side = dot(geometric_normal, ray.direction) > 0.0 ? -1.0 : 1.0;
    for (int k = 0; k < 3; ++k) corner_normals[k] = side * normalize(cofactor * corner_normals[k]);
    vec3 corners[3] = vec3[3](a, a + u, a + v);
    float offset_from_triangle = offset_along_normal(b, corners, corner_normals, side * geometric_normal);
    vec3 shading_normal = side * smooth_normal;

    Material material = fetch_Material(materials, corner.material);
    base_color = vec4(material.base_color, offset_from_triangle);
#if IMAGES || GRAPH
    // Footprints shrink with the number of samples: their mean replaces filtering by smaller copies.
    float scale = inversesqrt(1.0 + sample_index);
    vec3 dx = scale * (barycentric(view_ray(pixel + vec2(1.0, 0.0)), a, u, v, cross(u, v)) - exact);
    vec3 dy = scale * (barycentric(view_ray(pixel + vec2(0.0, 1.0)), a, u, v, cross(u, v)) - exact);
#endif
#if GRAPH
    bool is_mirrored = determinant(linear) < 0.0; // its triangles' backs are the object's front
    ShadingPoint at = ShadingPoint(p, b, shading_normal, side * geometric_normal, -normalize(ray.direction),
                                   (side < 0.0) != is_mirrored, triangle, int(id.y));
    vec3 tangent = orthogonal(at.geometric_normal), bitangent = cross(at.geometric_normal, tangent);
    float size = pixel_size(ray, pixel, length(to_p));
    Differentials differentials =
        Differentials(shift(dx, u, v), shift(dy, u, v), shift(in_plane(size * tangent, u, v), u, v),
                      shift(in_plane(size * bitangent, u, v), u, v));
    Closures closures = evaluate_graph(at, differentials, material.first_constant);
    base_color.rgb = closures.diffuse;
    vec3 mean_normal = normalize(closures.normal);
    float square = dot(mean_normal, mean_normal); // 1, unless the sum is 0 or no number
    if (square > 0.5 && square < 2.0) shading_normal = mean_normal;
#if BUMPS
    bool is_bumped = closures.shadows_bumps && distance(shading_normal, at.normal) > MIN_BUMP;
    uint bumps = is_bumped ? pack_smooth_normal(at.normal) : 0u;
#else
    const uint bumps = 0u;
#endif
#if GLOSSY
    write_lobes(closures, at.incoming, shading_normal, bumps);
#elif BUMPS && !LAYERS
    Gloss none = Gloss(vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), 1.0, 0.0, 0.0, 0.0, vec4(0.0));
    gloss_rise = pack_rise(none, bumps);
#endif
#elif IMAGES
    if (material.image >= 0) {
        Image image = image_at(material.image);
        mat3x2 uvs = corner_uvs(triangle);
        base_color.rgb =
            image_color(image, uvs * b, uvs * dx, uvs * dy, image.repeat != 0 ? REPEAT : EXTEND).rgb;
    }
#endif
    vec2 octahedron = octahedron_from_direction(shading_normal);
    uint geometric = pack_octahedron(octahedron_from_direction(side * geometric_normal));
    normal = uvec4(pack_octahedron(octahedron), geometric, id);
    position = vec4(p, pack_normal(octahedron));
}
