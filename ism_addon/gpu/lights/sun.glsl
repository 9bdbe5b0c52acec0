// Suns: parallel light, or light of uniform radiance from a cap of directions. A surface that faces one has the
// irradiance 1 W/m^2.
// A shader variant for lights with or without an angle sets one of these to 0, as some drivers execute both branches.
#ifndef SUNS_WITH_ANGLE
#define SUNS_WITH_ANGLE 1
#endif
#ifndef SUNS_WITHOUT_ANGLE
#define SUNS_WITHOUT_ANGLE 1
#endif
#include "closed_forms/spherical_cap.glsl"
#include "sampling/spherical_cap.glsl"

bool sun_has_angle(Light light) {
    return SUNS_WITHOUT_ANGLE == 0 || (SUNS_WITH_ANGLE == 1 && light.radius > 0.0);
}

float sun_radiance(Light light) { return 0.3183098861837907 / (light.radius * light.radius); }

float sun_irradiance(Light light, vec3 p, vec3 n) {
    float cosine = -dot(n, light.normal);
    if (!sun_has_angle(light) || cosine >= light.radius) return max(cosine, 0.0);
    return spherical_cap_irradiance(cosine, light.radius) * sun_radiance(light);
}

// Where a ray has left the scene.
vec3 sun_point(vec3 p, vec3 wi) { return p + 2.0 * scene_extent.x * wi; }

LightSample sun_sample(Light light, vec3 p, vec3 n, vec2 uv) {
    vec3 axis = -light.normal;
    if (!sun_has_angle(light)) return LightSample(sun_point(p, axis), axis, 1.0, 1.0, -1);
    CapSample s = cap_sample(axis, light.radius, n, uv);
    float to_axis = dot(s.wi, axis);
    bool hits = to_axis > 0.0 && to_axis * to_axis >= (1.0 - light.radius * light.radius) * (1.0 - 1e-6);
    float radiance = hits && s.pdf > 0.0 ? sun_radiance(light) : 0.0;
    return LightSample(sun_point(p, s.wi), s.wi, radiance, max(s.pdf, 1e-37), -1);
}

float sun_emitted(Light light, vec3 p, vec3 wi) {
    bool hits = sun_has_angle(light) && dot(light.normal, wi) < 0.0 && is_in_cap(-light.normal, light.radius, wi);
    return hits ? sun_radiance(light) : 0.0;
}

float sun_pdf(Light light, vec3 p, vec3 n, vec3 wi) {
    if (!sun_has_angle(light) || dot(n, wi) <= 0.0) return 0.0;
    return cap_pdf(-light.normal, light.radius, n, wi);
}

// Virtual lights are directions.
float sun_virtual_weight(Light light, vec3 v, vec3 n, vec3 axis) { return max(-dot(n, axis), 0.0); }

vec3 sun_centre(Light light, vec3 p, vec3 to) { return p + dot(to - p, light.normal) * light.normal; }

// Behind all surfaces, before the background.
float sun_hit_distance(Light light, vec3 p, vec3 wi) { return 1e29; }
