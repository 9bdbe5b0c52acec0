// Whether it is a pixel's turn to have a ray: as often as that is worth it.
#include "lib/luminance.glsl"
#include "lib/shadow_ray.glsl"
uniform vec2 ray_steps;
uniform float enough; // change of luminance that is worth a ray
flat in float own_number;

// Luminance of irradiance by which more of a light would raise the picture: less of it, where a light is negative.
float headroom(float bright, float known) { return max(bright * (1.0 - known), -bright * known); }

struct Turn { bool now; float number; float chance; }; // of the ray, counting those that the pixel had

// `known` of a light that would bring `full` is thought to be seen; TRUST is the doubt where all rays agree on that.
float chance_of(vec3 radiance, vec3 albedo, float full, float known, bool doubtful) {
    float bright = abs(luminance(radiance * albedo)) * full / 3.141592653589793;
    float worth = bright * (doubtful ? sqrt(max(known * (1.0 - known), 0.05)) : TRUST) / enough;
    // A power of two: pixels close by have the same, and take turns together, as processors work on several at once.
    return clamp(exp2(floor(log2(worth))), LEAST_CHANCE, 1.0);
}

// Rays are numbered, so that they go through places that are spread evenly, however rare they are.
Turn turn_of(ivec2 at, vec2 place, float chance) {
    float phase = place_of_pixel(at / 4, place).x;
    // After each round of the places in the pixel at another time, or rays would only ever start at some of them.
    if (chance < 1.0) phase += floor(own_number / float(PLACES_IN_PIXEL)) * ray_steps.x;
    float number = floor(own_number * chance + phase);
    return Turn(floor((own_number + 1.0) * chance + phase) > number, number, chance);
}
