// Predictions belong to the surface that was visible at a pixel when they were made. If another one is visible now, those
// of a neighbour on that surface are used instead.
#include "surfaces/surface.glsl"
uniform sampler2D prediction_surface; // positions and normals then

struct PredictedPixel { ivec2 at; bool similar; }; // without a similar one, the pixel itself

PredictedPixel predicted_pixel(Surface surface, ivec2 at) {
    ivec2 last = last_pixel(), chosen = at;
    vec2 texel = texel_size(prediction_surface);
    float best = 0.0;
    for (int k = 0, taps = 9; k < taps; ++k) { // the pixel itself first
        ivec2 other = clamp(at + ivec2((k + 4) % 3 - 1, (k + 4) % 9 / 3 - 1), ivec2(0), last);
        vec4 other_surface = fetch(prediction_surface, other, texel);
        float same_surface = similarity(surface.position, surface.normal, surface.depth, other_surface);
        if (same_surface > best) chosen = other;
        best = max(best, same_surface);
        if (k == 0 && best > 0.5) taps = 1;
    }
    return PredictedPixel(chosen, best >= 0.5);
}
