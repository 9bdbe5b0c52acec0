// Emission that the camera sees along a ray.
#include "surfaces/camera_ray.glsl"
#include "surfaces/tint.glsl"
#if SEEN_LIGHTS
#include "lights/light.glsl"
uniform int seen_lights; // rows of LIGHT
uniform int seen_count;
#endif
#if EMISSIVE
#include "trace/triangle_fetch.glsl"
uniform usamplerBuffer materials;
#endif
#if EMISSION_GRAPHS
#include "surfaces/shading_point.glsl"
#include "surfaces/surface_emission.glsl"
const float MAX_EMISSION = 1e30, MIN_OPACITY = 1e-3;
#endif

const float FAR = 1e30; // beyond all surfaces, m

// Radiance of the lights between two distances, m. The camera sees through them, as in Cycles. Those before all surfaces
// that tint are not tinted.
vec3 seen_radiance(Ray ray, float nearest, float farthest, Tint tint) {
    vec3 sum = vec3(0.0);
#if SEEN_LIGHTS
    vec3 wi = normalize(ray.direction);
    for (int k = 0; k < seen_count; ++k) {
        Light light = fetch_Light(scene_records, seen_lights + k);
        float emitted = light_emitted(light, ray.origin, wi);
        if (emitted <= 0.0) continue;
        float distance = light_hit_distance(light, ray.origin, wi);
        vec3 point = ray.origin + distance * wi;
        if (distance < nearest || distance >= farthest) continue;
        vec3 passes = distance > tint.depth * length(ray.direction) ? tint.color : vec3(1.0);
        sum += passes * emitted * light.emission * light_color(light, ray.origin, point, -1);
    }
#endif
    return sum;
}

#if EMISSIVE
// Radiance of a surface at a point.
vec3 surface_radiance(int triangle, int instance, vec3 p, vec3 incoming) {
    int material = fetch_triangle(triangle).material;
#if EMISSION_GRAPHS
    if (has_emission(material)) {
        vec4 emitted = emission(material, shading_point(triangle, instance, p, incoming));
        vec3 radiance = emitted.rgb / max(1.0 - emitted.a, MIN_OPACITY);
        return any(isnan(radiance)) ? vec3(0.0) : clamp(radiance, -MAX_EMISSION, MAX_EMISSION);
    }
#endif
    return fetch_Material(materials, material).emission;
}
#endif

// Of the surface at a depth along the view's axis, and of the lights before it. Triangle -1: there is no surface.
vec3 emission_along(Ray ray, float depth, int triangle, int instance, Tint tint) {
    vec3 sum = seen_radiance(ray, 0.0, triangle < 0 ? FAR : depth * length(ray.direction), tint);
#if EMISSIVE
    vec3 p = ray.origin + depth * ray.direction;
    if (triangle >= 0) sum += tint.color * surface_radiance(triangle, instance, p, -normalize(ray.direction));
#endif
    return sum;
}
