// The pixel whose prediction was made for the most similar surface.
#include "surfaces/surface.glsl"
#include "surfaces/predicted_pixel.glsl"
uniform sampler2D prediction_surface; // positions and normals for which predictions were made
out float packed_pixel;

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    Surface surface = surface_at(at);
    vec2 texel = texel_size(prediction_surface);
    float best = 0.0;
    int chosen = 0;
    for (int k = 0, taps = NEIGHBOURHOOD; k < taps; ++k) { // the pixel itself first
        vec4 other_surface = fetch(prediction_surface, neighbour(at, k), texel);
        float same_surface = similarity(surface.position, surface.normal, surface.depth, other_surface);
        if (same_surface > best) chosen = k;
        best = max(best, same_surface);
        if (k == 0 && best > 0.5) taps = 1;
    }
    packed_pixel = pack_predicted_pixel(chosen, best >= 0.5);
}
