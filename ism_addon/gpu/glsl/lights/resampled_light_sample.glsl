// A sample of a light, resampled near a light BVH (Talbot, Cline & Egbert 2005). There most of the irradiance can come
// from a few triangles that are seldom chosen, as the bounds of nodes say little about what is near the receiver.
#include "lights/light.glsl"

#if MESHES_WITH_BVH
// Of these and of EmissiveMesh.max_rays, the least error for the time in the scene lanterns of `bench error`.
const float NEAR_IRRADIANCE = 1.5; // by a radiance of 1
const int CANDIDATES = 8;

// `irradiance`: of the receiver, by a radiance of 1. Candidates divide the light evenly. One is chosen in proportion to
// the irradiance that it estimates, by the digits of uv.x above 1 / CANDIDATES, and below them by those of uv.y that
// hardly move a candidate. Far from the light the loops are skipped, which all drivers can do with loops.
LightSample resampled_light_sample(Light light, vec3 p, vec3 n, vec2 uv, float irradiance) {
    int count = light.leaves > 0 && irradiance > NEAR_IRRADIANCE ? CANDIDATES : 0;
    float weights[MAX_EXACT_TRIANGLES], sum = 0.0, own, rest = modf(uv.x * float(CANDIDATES), own);
    for (int k = 0; k < count; ++k) {
        LightSample candidate = light_sample(light, p, n, vec2((float(k) + rest) / float(CANDIDATES), uv.y));
        weights[k] = candidate.radiance * max(dot(n, candidate.wi), 0.0) / candidate.pdf;
        sum += weights[k];
    }
    float u = (own + fract(uv.y * 4096.0)) / float(CANDIDATES);
    float chosen = count > 0 ? float(sample_discrete(weights, count, u).index) : own;
    LightSample from = light_sample(light, p, n, vec2((chosen + rest) / float(CANDIDATES), uv.y));
    float pdf = from.radiance * max(dot(n, from.wi), 0.0) * float(CANDIDATES) / max(sum, 1e-37);
    from.pdf = count > 0 ? max(pdf, 1e-37) : from.pdf;
    return from;
}
#else
LightSample resampled_light_sample(Light light, vec3 p, vec3 n, vec2 uv, float irradiance) {
    return light_sample(light, p, n, uv);
}
#endif
