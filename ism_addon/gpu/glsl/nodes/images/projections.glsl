// Images that are projected onto surfaces from a sphere, a tube or the sides of a box. As in Cycles.
#include "nodes/object.glsl"
#include "nodes/images/image.glsl"

// Longitude in 0 to 1, of points around the middle of a unit cube.
float longitude(vec2 p) { return p == vec2(0.0) ? 0.0 : 0.5 - 0.5 * atan(p.x, p.y) / HALF_CIRCLE; }

vec3 sphere_uv(vec3 p) {
    float radius = length(p);
    return radius > 0.0 ? vec3(longitude(p.xy), 1.0 - acos(clamp(p.z / radius, -1.0, 1.0)) / HALF_CIRCLE, 0.0)
                        : vec3(0.0);
}

vec3 tube_uv(vec3 p) { return p.xy == vec2(0.0) ? vec3(0.0) : vec3(longitude(p.xy), 0.5 * p.z + 0.5, 0.0); }

vec3 from_middle(vec3 p) { return 2.0 * p - 1.0; }

vec4 image_sphere(float image, vec3 p, vec3 dx, vec3 dy, int sampling) {
    vec3 uv = sphere_uv(from_middle(p));
    return image_interpolated(image, uv, around(sphere_uv(from_middle(p + dx)) - uv),
                              around(sphere_uv(from_middle(p + dy)) - uv), sampling);
}

vec4 image_tube(float image, vec3 p, vec3 dx, vec3 dy, int sampling) {
    vec3 uv = tube_uv(from_middle(p));
    return image_interpolated(image, uv, around(tube_uv(from_middle(p + dx)) - uv),
                              around(tube_uv(from_middle(p + dy)) - uv), sampling);
}

// How much of the sides along x, y and z a point shows: one side, or within `blend` of their edges and corners several.
vec3 box_weights(vec3 normal, float blend) {
    vec3 n = abs(normal), weights = vec3(0.0);
    n /= max(n.x + n.y + n.z, 1e-30);
    float limit = 0.5 + 0.5 * blend;
    for (int k = 0; k < 3; ++k) {
        int next = (k + 1) % 3, last = (k + 2) % 3;
        if (n[k] > limit * (n[k] + n[next]) && n[k] > limit * (n[k] + n[last])) {
            weights[k] = 1.0;
            return weights;
        }
    }
    if (blend <= 0.0) return vec3(1.0, 0.0, 0.0);
    for (int k = 0; k < 3; ++k) {
        int one = (k + 1) % 3, other = (k + 2) % 3;
        float sum = n[one] + n[other];
        if (n[k] < (1.0 - limit) * sum) {
            weights[one] = saturate((n[one] / sum - 0.5 + 0.5 * blend) / blend);
            weights[other] = 1.0 - weights[one];
            return weights;
        }
    }
    return ((2.0 - limit) * n + limit - 1.0) / (2.0 * limit - 1.0);
}

vec3 box_side(vec3 p, int axis) { return vec3(axis == 0 ? p.yz : axis == 1 ? p.xz : p.yx, 0.0); }

vec4 image_box(ShadingPoint at, float image, float blend, vec3 p, vec3 dx, vec3 dy, int sampling) {
    vec3 n = coordinate_normal(at), weights = box_weights(n, blend);
    bvec3 is_mirrored = bvec3(n.x < 0.0, n.y > 0.0, n.z > 0.0);
    vec4 sum = vec4(0.0);
    for (int k = 0; k < 3; ++k) {
        if (weights[k] <= 0.0) continue;
        vec3 uv = box_side(p, k);
        if (is_mirrored[k]) uv.x = 1.0 - uv.x;
        sum += weights[k] * image_interpolated(image, uv, box_side(dx, k), box_side(dy, k), sampling);
    }
    return sum;
}
