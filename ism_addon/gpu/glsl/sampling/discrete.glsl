// An index, sampled in proportion to weights: of at most as many as triangles that have a closed form together.
#include "lights/emissive_limits.glsl"

struct DiscreteSample { int index; float probability; };

// `u` in [0,1): is replaced by another number. Weights have contiguous intervals of u, in their order, so that
// stratified u stay stratified.
DiscreteSample sample_discrete(float weights[MAX_EXACT_TRIANGLES], int count, inout float u) {
    float sum = 0.0, chosen_weight = 0.0;
    for (int k = 0; k < count; ++k) sum += weights[k];
    float target = u * sum;
    int chosen = 0;
    for (int k = 0; k < count; ++k) {
        bool takes = weights[k] > 0.0 && (target >= 0.0 || chosen_weight == 0.0);
        chosen = takes ? k : chosen;
        chosen_weight = takes ? weights[k] : chosen_weight;
        u = takes ? clamp(target / weights[k], 0.0, 0.99999994) : u;
        target -= weights[k];
    }
    return DiscreteSample(chosen, chosen_weight / max(sum, 1e-37));
}
