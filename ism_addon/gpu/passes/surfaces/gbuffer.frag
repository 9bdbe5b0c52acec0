// The surface of a pixel, from its triangle's index.
#include "trace/triangle_fetch.glsl"
#include "maths/octahedron.glsl"
#include "maths/packed_normal.glsl"
#include "surfaces/camera_ray.glsl"
#include "surfaces/material_outputs.glsl"
#include "surfaces/terminator_offset.glsl"
#if IMAGES
#include "textures/image.glsl"
uniform samplerBuffer uvs;

vec2 uv_at(int corner) { return texelFetch(uvs, corner).xy; }
#endif

uniform usampler2D visibility_buffer;
uniform mat2 fine_from_pixel;
uniform vec2 first; // fine pixel of the first pixel
uniform ivec2 last; // and the last one that there is
flat in vec4 visibility_texel_and_offset;
flat in float sample_index;
uniform usamplerBuffer instances;
uniform usamplerBuffer materials;
uniform isamplerBuffer corner_normal_buffer;
layout(location = 0) out float depth;
layout(location = 1) out vec4 position;
layout(location = 2) out vec4 normal;
layout(location = 3) out vec4 base_color;
layout(location = 4) out uvec2 primitive;

const float MAX_RELATIVE_SIZE = 100.0; // a triangle's size over its distance

// Barycentric coordinates of where a ray meets the plane of the triangle a, a + u, a + v, whose normal is n.
vec3 barycentric(Ray ray, vec3 a, vec3 u, vec3 v, vec3 n) {
    vec3 q = cross(ray.direction, ray.origin - a);
    float scale = 1.0 / dot(ray.direction, n);
    float s = dot(v, q) * scale, t = -dot(u, q) * scale;
    return vec3(1.0 - s - t, s, t);
}

// Barycentric coordinates of the point on the triangle's edges that is nearest to a ray which misses the triangle. Clamping
// would move it far along a long and thin triangle.
vec3 nearest_edge_barycentric(Ray ray, vec3 a, vec3 u, vec3 v) {
    vec3 corners[3] = vec3[3](a, a + u, a + v), way = normalize(ray.direction), found = vec3(1.0, 0.0, 0.0);
    float nearest = 1e38;
    for (int k = 0; k < 3; ++k) {
        vec3 begin = corners[k] - ray.origin, along = corners[(k + 1) % 3] - corners[k];
        vec3 off = begin - way * dot(begin, way), across = along - way * dot(along, way); // as the ray sees them
        float part = clamp(-dot(off, across) / max(dot(across, across), 1e-38), 0.0, 1.0);
        vec3 apart = off + part * across;
        float square = dot(apart, apart);
        vec3 b = vec3(0.0);
        b[k] = 1.0 - part;
        b[(k + 1) % 3] = part;
        if (square < nearest) found = b;
        nearest = min(nearest, square);
    }
    return found;
}

void main() {
    ivec2 at = ivec2(fine_from_pixel * floor(gl_FragCoord.xy) + first + visibility_texel_and_offset.xy + 0.5);
    vec2 pixel = gl_FragCoord.xy + visibility_texel_and_offset.zw;
    uvec2 id = fetch(visibility_buffer, clamp(at, ivec2(0), last)).xy;
    primitive = id;
    if (id.x == 0u) {
        depth = BACKGROUND_DEPTH;
        position = normal = base_color = vec4(0.0);
        clear_material_inputs();
        return;
    }
    int triangle = int(id.x) - 1;
    Instance here = fetch_Instance(instances, int(id.y));
    mat3 linear = transpose(mat3(here.row0.xyz, here.row1.xyz, here.row2.xyz));
    vec3 offset = vec3(here.row0.w, here.row1.w, here.row2.w);

    TriangleVertices corner = fetch_triangle(triangle);
    vec3 a = linear * corner.first + offset, u = linear * corner.u, v = linear * corner.v;
    vec3 geometric_normal = cross(u, v);

    Ray ray = view_ray(pixel);
    vec3 exact = barycentric(ray, a, u, v, geometric_normal);
    vec3 b = all(greaterThanEqual(exact, vec3(0.0))) ? exact : nearest_edge_barycentric(ray, a, u, v);
    vec3 p = a + u * b.y + v * b.z, way = p - ray.origin;
    // Barycentric coordinates of a vast triangle are too coarse. Its plane is precise.
    if (max(dot(u, u), dot(v, v)) > MAX_RELATIVE_SIZE * MAX_RELATIVE_SIZE * dot(way, way))
        p = ray.origin + ray.direction * (dot(way, geometric_normal) / dot(ray.direction, geometric_normal));
    depth = -(view_from_anchor * vec4(p, 1.0)).z;

    // Normals go by the cofactor matrix, which a mirrored instance turns inside out, as it does its triangles.
    linear /= max(max(length(linear[0]), length(linear[1])), length(linear[2])); // steps are short
    mat3 cofactor = mat3(cross(linear[1], linear[2]), cross(linear[2], linear[0]), cross(linear[0], linear[1]));
    vec3 smooth_normal = vec3(0.0);
    vec3 corner_normals[3];
    for (int k = 0; k < 3; ++k) {
        vec2 octahedra = vec2(texelFetch(corner_normal_buffer, 3 * triangle + k).xy) / 32767.0;
        corner_normals[k] = direction_from_octahedron(octahedra);
        smooth_normal += b[k] * corner_normals[k];
    }
    smooth_normal = normalize(cofactor * smooth_normal);
    geometric_normal = normalize(geometric_normal);
    float side = dot(geometric_normal, ray.direction) > 0.0 ? -1.0 : 1.0;
    for (int k = 0; k < 3; ++k) corner_normals[k] = side * normalize(cofactor * corner_normals[k]);
    float offset_from_triangle = terminator_offset(b, vec3[3](a, a + u, a + v), corner_normals);
    normal = vec4(octahedron_from_direction(side * smooth_normal), octahedron_from_direction(side * geometric_normal));
    position = vec4(p, pack_normal(normal.xy));

    Material material = fetch_Material(materials, corner.material);
    base_color = vec4(material.base_color, offset_from_triangle);
    write_material_inputs(material);
#if IMAGES
    if (material.width > 0) {
        mat3x2 at = mat3x2(uv_at(3 * triangle), uv_at(3 * triangle + 1), uv_at(3 * triangle + 2));
        vec3 bx = barycentric(view_ray(pixel + vec2(1.0, 0.0)), a, u, v, cross(u, v));
        vec3 by = barycentric(view_ray(pixel + vec2(0.0, 1.0)), a, u, v, cross(u, v));
        // A sample's share of the pixel: the more samples, the less is left to the image's smaller copies.
        float share = inversesqrt(1.0 + sample_index);
        base_color.rgb = image_color(material, at * b, share * (at * (bx - exact)), share * (at * (by - exact)));
    }
#endif
}
