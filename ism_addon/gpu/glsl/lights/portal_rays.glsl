// Rays to a light whose samples may go through portals: PORTALS is its shape then, and 0 otherwise.
const float MAX_RAY_WEIGHT = 10.0; // of one ray in a predicted visibility: others weigh about 1

// What a ray counts for in the visibility of a light: its samples may not be distributed as the irradiance is.
float ray_weight(Light light, vec3 n, LightSample from) {
#if PORTALS
    if (light.shape == PORTALS) return min(cosine_hemisphere_pdf(dot(n, from.wi)) / from.pdf, MAX_RAY_WEIGHT);
#endif
    return 1.0;
}

// The importance of a ray, by the density of the light's samples in its direction: few beside portals are unoccluded.
float ray_importance(Light light, vec3 n, vec3 wi, float pdf) {
#if PORTALS
    float beside = (1.0 - portal_probability) * cosine_hemisphere_pdf(max(dot(n, wi), 0.0));
    if (light.shape == PORTALS && pdf <= 1.0001 * beside) return importance_beside;
#endif
    return 1.0;
}
