// Which samples trace a ray at a pixel. The probability is proportional to how much the ray can change the pixel.
#include "maths/luminance.glsl"
#include "sampling/sample_index.glsl"
#include "trace/shadow_ray.glsl"
uniform uvec2 ray_steps;
uniform uvec2 late_ray_steps; // of a pixel's rays from EARLY_RAYS on
uniform uvec2 schedule_steps; // from pixel to pixel, and after each round of the subpixel offsets
uniform float ray_threshold; // change of luminance for which each sample traces a ray, at the picture's mean
flat in float tile_tolerance;

// Upper bound of the increase of a pixel's luminance if the predicted visibility of a light is wrong. `unshadowed`: the
// light's unshadowed luminance, which can be negative. There is no bound if it is not exact.
float headroom(float unshadowed, float visibility, bool exact) {
    return exact ? max(unshadowed * (1.0 - visibility), -unshadowed * visibility) : 1e30;
}

const uint EARLY_RAYS = 64u;

// The shift of a pixel's sequence of points on a light for its ray of this index.
uvec2 ray_shift(float index) {
    uint early = min(uint(index), EARLY_RAYS);
    return early * ray_steps + (uint(index) - early) * late_ray_steps;
}

struct ScheduledRays { float first; float count; }; // indices among the pixel's rays

const float RAYLESS = 1048576.0; // the first index of samples that take no ray

// Standard deviation of what a ray says of a visibility that is predicted to be this.
float ray_doubt(float visibility, bool uncertain) {
    if (!uncertain) return MIN_DOUBT;
#if PORTALS
    float second_moment = visibility * (portal_moments.x * visibility + portal_moments.y);
    return sqrt(max(second_moment - visibility * visibility, MIN_DOUBT * MIN_DOUBT));
#else
    return sqrt(max(visibility * (1.0 - visibility), 0.05));
#endif
}

// Number of rays a sample, on average, to a light of this predicted visibility and unshadowed luminance.
float ray_rate(float unshadowed, float visibility, bool uncertain) {
    float deviation = abs(unshadowed) * ray_doubt(visibility, uncertain);
    // Powers of two, so that neighbouring pixels trace in the same samples: processors execute several at once.
    return clamp(exp2(floor(log2(deviation / (tile_tolerance * ray_threshold)))), MIN_PROBABILITY, float(MAX_RAYS));
}

// A ray's index counts the traced rays of its pixel, so that even rare rays go to evenly distributed points.
// `phase`: of the light.
ScheduledRays schedule_rays(ivec2 at, uint phase, float rate) {
    // The start changes after each round of subpixel offsets: otherwise rays would start at the same ones only.
    uint rounds = uint(sample_index) / uint(SUBPIXEL_OFFSETS);
    uint fixed_start = phase + pixel_index(at / 4) * schedule_steps.x + rounds * schedule_steps.y;
    float start = float(fixed_start >> 8u) / 16777216.0;
    if (rate >= 1.0) start = 0.0;
    float first = floor(sample_index * rate + start);
    return ScheduledRays(first, floor((sample_index + 1.0) * rate + start) - first);
}
