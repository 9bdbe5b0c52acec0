// Samples of the world's directions through portals, see culling/portals.py. A portal is a rectangle like an area light.
#include "sampling/discrete.glsl"
uniform int portals;              // rows of LIGHT
uniform int portal_count;         // at most MAX_EXACT_TRIANGLES
uniform float portal_probability; // of a sample through one of them, where any is above the horizon
uniform vec2 portal_moments;      // of a ray's visibility, the second: factors of the visibility's square, and of itself
uniform float importance_beside;  // of rays that cross none, relative to those that do

Light fetch_portal(int k) { return fetch_Light(scene_records, portals + k); }

struct PortalWeights { float irradiance[MAX_EXACT_TRIANGLES]; float sum; };

PortalWeights portal_weights(vec3 p, vec3 n) {
    PortalWeights weights;
    weights.sum = 0.0;
    for (int k = 0; k < portal_count; ++k) {
        weights.irradiance[k] = max(area_irradiance_without_spread(fetch_portal(k), p, n), 0.0);
        weights.sum += weights.irradiance[k];
    }
    return weights;
}

// `beside`: the density of samples that go through none.
float portals_pdf(PortalWeights weights, vec3 p, vec3 n, vec3 wi, float beside) {
    if (weights.sum <= 0.0) return beside;
    float pdf = 0.0;
    for (int k = 0; k < portal_count; ++k)
        if (weights.irradiance[k] > 0.0) pdf += weights.irradiance[k] / weights.sum * area_pdf(fetch_portal(k), p, n, wi);
    return mix(beside, pdf, portal_probability);
}

// Whether a sample goes through a portal; uv becomes what is left to choose it by.
bool goes_through(PortalWeights weights, inout vec2 uv) {
    float through = weights.sum > 0.0 ? portal_probability : 0.0;
    bool goes = uv.x < through;
    uv.x = goes ? uv.x / through : (uv.x - through) / (1.0 - through);
    return goes;
}

vec3 sample_portals(PortalWeights weights, vec3 p, vec3 n, vec2 uv) {
    int chosen = sample_discrete(weights.irradiance, portal_count, uv.x).index;
    return area_sample(fetch_portal(chosen), p, n, uv).wi;
}
