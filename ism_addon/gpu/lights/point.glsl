// Points: spheres of uniform radiance, or disks of the same radius that face the receiver. A receiver sees either as a
// spherical cap around the direction to the position, so their irradiance is that of a cap. All are of intensity 1 W/sr.
// A shader variant for lights with or without a radius sets one of these to 0, as some drivers execute both branches.
#ifndef POINTS_WITH_RADIUS
#define POINTS_WITH_RADIUS 1
#endif
#ifndef POINTS_WITHOUT_RADIUS
#define POINTS_WITHOUT_RADIUS 1
#endif
#include "closed_forms/spherical_cap.glsl"
#include "sampling/spherical_cap.glsl"

bool point_has_radius(Light light) {
    return POINTS_WITHOUT_RADIUS == 0 || (POINTS_WITH_RADIUS == 1 && light.radius > 0.0);
}

// What a receiver sees of a light: the square of the distance by which its intensity is divided, and the sine of half of
// the cap's angle, more than 1 inside a sphere.
struct PointCap { vec3 axis; float distance; float inverse_square; float sine; };

PointCap point_cap(Light light, vec3 p) {
    vec3 to = light.position - p;
    float square = dot(to, to), radius_square = light.radius * light.radius;
    float falloff = max(light.soft_falloff != 0 ? square + radius_square : square, 1e-30);
    float distance = sqrt(max(square, 1e-30));
    return PointCap(to / distance, distance, 1.0 / falloff, light.radius * inversesqrt(falloff));
}

float point_radiance(Light light) { return 0.3183098861837907 / (light.radius * light.radius); }

float point_irradiance(Light light, vec3 p, vec3 n) {
    PointCap cap = point_cap(light, p);
    float cosine = dot(n, cap.axis);
    if (!point_has_radius(light) || cosine >= cap.sine) return max(cosine, 0.0) * cap.inverse_square;
    if (cap.sine >= 1.0) return 1.0 / (light.radius * light.radius); // inside
    return spherical_cap_irradiance(cosine, cap.sine) * point_radiance(light);
}

// The distance to a sphere's surface, or to a disk, along a direction that meets it.
float point_distance(Light light, PointCap cap, float cosine) {
    float d = cap.distance;
    if (light.soft_falloff != 0) return d / max(cosine, 1e-6);
    float root = sqrt(max(light.radius * light.radius - d * d * (1.0 - cosine * cosine), 0.0));
    return d * cosine + (cap.sine < 1.0 ? -root : root);
}

LightSample point_sample(Light light, vec3 p, vec3 n, vec2 uv) {
    PointCap cap = point_cap(light, p);
    if (!point_has_radius(light)) return LightSample(light.position, cap.axis, cap.inverse_square, 1.0, -1);
    CapSample s = cap_sample(cap.axis, cap.sine, n, uv);
    float to_axis = dot(s.wi, cap.axis);
    bool hits = cap.sine >= 1.0 || (to_axis > 0.0 && to_axis * to_axis >= (1.0 - cap.sine * cap.sine) * (1.0 - 1e-6));
    float radiance = hits && s.pdf > 0.0 ? point_radiance(light) : 0.0;
    return LightSample(p + point_distance(light, cap, to_axis) * s.wi, s.wi, radiance, max(s.pdf, 1e-37), -1);
}

float point_emitted(Light light, vec3 p, vec3 wi) {
    if (!point_has_radius(light)) return 0.0;
    PointCap cap = point_cap(light, p);
    return is_in_cap(cap.axis, cap.sine, wi) ? point_radiance(light) : 0.0;
}

float point_pdf(Light light, vec3 p, vec3 n, vec3 wi) {
    if (!point_has_radius(light) || dot(n, wi) <= 0.0) return 0.0;
    PointCap cap = point_cap(light, p);
    return cap_pdf(cap.axis, cap.sine, n, wi);
}

// Virtual lights lie on the sphere, and face outwards.
float point_virtual_weight(Light light, vec3 v, vec3 n, vec3 axis) {
    float square = max(dot(v, v), 1e-30), height = dot(axis, v);
    float weight = max(-dot(n, v), 0.0) / (square * sqrt(square));
    return weight * (point_has_radius(light) ? max(height, 0.0) * inversesqrt(square) : (height > 0.0 ? 1.0 : 0.0));
}

vec3 point_centre(Light light, vec3 p, vec3 to) { return light.position; }

float point_hit_distance(Light light, vec3 p, vec3 wi) {
    PointCap cap = point_cap(light, p);
    return point_distance(light, cap, dot(wi, cap.axis));
}
