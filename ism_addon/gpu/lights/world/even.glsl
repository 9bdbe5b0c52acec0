// The world: light of radiance 1 from all directions.
#include "maths/orthonormal_basis.glsl"
#include "sampling/cosine_hemisphere.glsl"

float world_irradiance(Light light, vec3 p, vec3 n) { return 3.141592653589793; }

// Where a ray has left the scene.
vec3 world_point(vec3 p, vec3 wi) { return p + 2.0 * scene_extent.x * wi; }

// Of samples that go through no portal.
float world_pdf_beside(vec3 n, vec3 wi) { return cosine_hemisphere_pdf(max(dot(n, wi), 0.0)); }

#if PORTALS == WORLD
#include "lights/portals.glsl"

LightSample world_sample(Light light, vec3 p, vec3 n, vec2 uv) {
    PortalWeights weights = portal_weights(p, n);
    bool through = goes_through(weights, uv);
    vec3 wi = through ? sample_portals(weights, p, n, uv) : basis(n) * cosine_hemisphere(uv);
    float pdf = portals_pdf(weights, p, n, wi, world_pdf_beside(n, wi));
    float radiance = pdf > 0.0 ? 1.0 : 0.0; // rounded below the horizon
    return LightSample(world_point(p, wi), wi, radiance, max(pdf, 1e-37), -1);
}

float world_pdf(Light light, vec3 p, vec3 n, vec3 wi) {
    return portals_pdf(portal_weights(p, n), p, n, wi, world_pdf_beside(n, wi));
}
#else
LightSample world_sample(Light light, vec3 p, vec3 n, vec2 uv) {
    vec3 wi = basis(n) * cosine_hemisphere(uv);
    return LightSample(world_point(p, wi), wi, 1.0, max(cosine_hemisphere_pdf(dot(n, wi)), 1e-37), -1);
}

float world_pdf(Light light, vec3 p, vec3 n, vec3 wi) { return world_pdf_beside(n, wi); }
#endif

float world_emitted(Light light, vec3 p, vec3 wi) { return 1.0; }

// Virtual lights are directions.
float world_virtual_weight(Light light, vec3 v, vec3 n, vec3 axis) { return 4.0 * max(-dot(n, axis), 0.0); }

vec3 world_centre(Light light, vec3 p, vec3 to) { return to; }

// Behind all surfaces, before the background.
float world_hit_distance(Light light, vec3 p, vec3 wi) { return 1e29; }
