// Which samples trace a ray at a pixel: with a probability that follows how much the ray can change the pixel.
#include "maths/luminance.glsl"
#include "trace/shadow_ray.glsl"
uniform uvec2 ray_steps;
uniform uvec2 turn_steps;    // from pixel to pixel, and after each round of the subpixel offsets
uniform float ray_threshold; // change of luminance for which each sample traces a ray
flat in float sample_index;

// Most by which a pixel's luminance can rise if the visibility of a light is wrong. `unshadowed`: luminance of all of the
// light; it can be negative. No bound where it is not exact.
float headroom(float unshadowed, float visibility) {
    return EXACT == 1 ? max(unshadowed * (1.0 - visibility), -unshadowed * visibility) : 1e30;
}

struct ScheduledRay { bool trace; float index; float probability; }; // index among the pixel's rays

// Probability of a ray to a light of this predicted visibility, that adds the luminance `unshadowed` where nothing occludes
// it.
float ray_probability(float unshadowed, float visibility, bool uncertain) {
    float doubt = uncertain ? sqrt(max(visibility * (1.0 - visibility), 0.05)) : MIN_DOUBT;
    // A power of two: neighbouring pixels have the same one and trace in the same samples, as processors run several at once.
    return clamp(exp2(floor(log2(abs(unshadowed) * doubt / ray_threshold))), MIN_PROBABILITY, 1.0);
}

// The index of a ray counts those that were traced: so they go through evenly spread points, however rare they are. `phase`:
// of the light.
ScheduledRay schedule_ray(ivec2 at, uint phase, float probability) {
    // The start changes after each round of subpixel offsets: otherwise rays would start at the same ones only.
    uint rounds = uint(sample_index) / uint(SUBPIXEL_OFFSETS);
    float start = float((phase + pixel_member(at / 4) * turn_steps.x + rounds * turn_steps.y) >> 8u) / 16777216.0;
    if (probability == 1.0) start = 0.0;
    float index = floor(sample_index * probability + start);
    return ScheduledRay(floor((sample_index + 1.0) * probability + start) > index, index, probability);
}
