// Whether it is a pixel's turn to have a ray: as often as that is worth it.
#include "maths/luminance.glsl"
#include "trace/shadow_ray.glsl"
uniform uvec2 ray_steps;
uniform uvec2 turn_steps; // from pixel to pixel, and after each round of the places in the pixel
uniform float enough; // change of luminance that is worth a ray
flat in float own_number;

// Luminance of irradiance by which more of a light would raise the picture: less of it, where a light is negative.
float headroom(float bright, float known) { return max(bright * (1.0 - known), -bright * known); }

struct Turn { bool now; float number; float chance; }; // of the ray, counting those that the pixel had

// `known` of a light that would bring `full` is thought to be seen; MIN_DOUBT is the doubt where all rays agree on that.
float ray_probability(vec3 radiance, vec3 albedo, float full, float known, bool doubtful) {
    float bright = abs(luminance(radiance * albedo)) * full / 3.141592653589793;
    float worth = bright * (doubtful ? sqrt(max(known * (1.0 - known), 0.05)) : MIN_DOUBT) / enough;
    // A power of two: pixels close by have the same, and take turns together, as processors work on several at once.
    return clamp(exp2(floor(log2(worth))), MIN_PROBABILITY, 1.0);
}

// Rays are numbered, so that they go through places that are spread evenly, however rare they are. `phase`: of the light.
Turn schedule_ray(ivec2 at, uint phase, float chance) {
    // After each round of the places in the pixel at another time, or rays would only ever start at some of them.
    uint rounds = uint(own_number) / uint(SUBPIXEL_OFFSETS);
    float start = float((phase + pixel_member(at / 4) * turn_steps.x + rounds * turn_steps.y) >> 8u) / 16777216.0;
    if (chance == 1.0) start = 0.0;
    float number = floor(own_number * chance + start);
    return Turn(floor((own_number + 1.0) * chance + start) > number, number, chance);
}
