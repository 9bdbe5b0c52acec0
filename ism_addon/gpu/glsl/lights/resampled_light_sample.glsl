// A sample of a light, resampled near a light BVH (Talbot, Cline & Egbert 2005). There most of the irradiance can come
// from a few triangles that are seldom chosen, as the bounds of nodes say little about what is near the receiver.
#include "lights/light.glsl"

#if MESHES_WITH_BVH
// Of these and of EmissiveMesh.max_rays, the least error for the time in the scene lanterns of `bench error`.
const float NEAR_IRRADIANCE = 1.5; // by a radiance of 1
const int CANDIDATES = 8;

// `irradiance`: of the receiver, by a radiance of 1. There is a candidate in each stratum of uv.x. One is chosen in
// proportion to the irradiance that it estimates. The stratum of uv.x decides which, with low digits of uv.y, on which no
// candidate depends visibly. Far from the light both loops end at once: all drivers skip loops, but not all branches.
LightSample resampled_light_sample(Light light, vec3 p, vec3 n, vec2 uv, float irradiance) {
    int count = light.leaves > 0 && irradiance > NEAR_IRRADIANCE ? CANDIDATES : 0;
    float weights[MAX_EXACT_TRIANGLES], sum = 0.0, stratum, within = modf(uv.x * float(CANDIDATES), stratum);
    for (int k = 0; k < count; ++k) {
        LightSample candidate = light_sample(light, p, n, vec2((float(k) + within) / float(CANDIDATES), uv.y));
        weights[k] = candidate.radiance * max(dot(n, candidate.wi), 0.0) / candidate.pdf;
        sum += weights[k];
    }
    float u = (stratum + fract(uv.y * 4096.0)) / float(CANDIDATES);
    float chosen = count > 0 ? float(sample_discrete(weights, count, u).index) : stratum;
    LightSample from = light_sample(light, p, n, vec2((chosen + within) / float(CANDIDATES), uv.y));
    float pdf = from.radiance * max(dot(n, from.wi), 0.0) * float(CANDIDATES) / max(sum, 1e-37);
    from.pdf = count > 0 ? max(pdf, 1e-37) : from.pdf;
    return from;
}
#else
LightSample resampled_light_sample(Light light, vec3 p, vec3 n, vec2 uv, float irradiance) {
    return light_sample(light, p, n, uv);
}
#endif
