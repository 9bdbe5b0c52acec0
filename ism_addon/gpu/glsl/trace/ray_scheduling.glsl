// Which samples trace a ray at a pixel: as often as that is worth it.
#include "maths/luminance.glsl"
#include "trace/shadow_ray.glsl"
uniform uvec2 ray_steps;
uniform uvec2 turn_steps;    // from pixel to pixel, and after each round of the subpixel offsets
uniform float ray_threshold; // change of luminance that is worth a ray
flat in float sample_index;

// Luminance by which more of a light would raise the picture: less of it, where a light is negative. `unshadowed` is the
// luminance of all of the light, as far as that is exact.
float headroom(float unshadowed, float visibility) {
    return EXACT == 1 ? max(unshadowed * (1.0 - visibility), -unshadowed * visibility) : 1e30;
}

struct ScheduledRay { bool trace; float index; float probability; }; // index among the rays that the pixel had

// Of a ray that tests a predicted visibility of a light that adds this luminance where nothing hides it. MIN_DOUBT is the
// doubt where all rays agree on the prediction.
float ray_probability(float unshadowed, float visibility, bool uncertain) {
    float doubt = uncertain ? sqrt(max(visibility * (1.0 - visibility), 0.05)) : MIN_DOUBT;
    // A power of two: pixels close by have the same, and trace in the same samples, as processors work on several at once.
    return clamp(exp2(floor(log2(abs(unshadowed) * doubt / ray_threshold))), MIN_PROBABILITY, 1.0);
}

// Rays are numbered, so that they go through points that are spread evenly, however rare they are. `phase`: of the light.
ScheduledRay schedule_ray(ivec2 at, uint phase, float probability) {
    // After each round of the subpixel offsets at another time, or rays would only ever start at some of them.
    uint rounds = uint(sample_index) / uint(SUBPIXEL_OFFSETS);
    float start = float((phase + pixel_member(at / 4) * turn_steps.x + rounds * turn_steps.y) >> 8u) / 16777216.0;
    if (probability == 1.0) start = 0.0;
    float index = floor(sample_index * probability + start);
    return ScheduledRay(floor((sample_index + 1.0) * probability + start) > index, index, probability);
}
