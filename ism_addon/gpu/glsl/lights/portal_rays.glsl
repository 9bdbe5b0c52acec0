// Rays to a light whose samples may go through portals: PORTALS is its shape then, and 0 otherwise.
const float MAX_RAY_WEIGHT = 10.0; // of one ray in a predicted visibility: others weigh about 1

#if PORTALS == ENVIRONMENT
float pdf_beside_portals(vec3 n, vec3 wi) { return environment_pdf_beside(n, wi); }
#elif PORTALS
float pdf_beside_portals(vec3 n, vec3 wi) { return world_pdf_beside(n, wi); }
#endif

// What a ray counts for in the visibility of a light: its samples may not be distributed as the irradiance is.
float ray_weight(Light light, vec3 n, LightSample from) {
#if PORTALS
    if (light.shape == PORTALS) return min(pdf_beside_portals(n, from.wi) / from.pdf, MAX_RAY_WEIGHT);
#endif
    return 1.0;
}

// The importance of a ray, by the density of the light's samples in its direction: few beside portals are unoccluded.
float ray_importance(Light light, vec3 n, vec3 wi, float pdf) {
#if PORTALS
    if (light.shape != PORTALS) return 1.0;
    float beside = (1.0 - portal_probability) * pdf_beside_portals(n, wi);
    if (pdf <= 1.001 * beside) return importance_beside;
#endif
    return 1.0;
}
