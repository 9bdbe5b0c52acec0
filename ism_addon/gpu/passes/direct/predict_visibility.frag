// What part of a light a pixel sees: between the pixels that scouted, as far as they show the surface that is here.
#include "textures/bilateral_upsample.glsl"
uniform sampler2D around; // see predict_visibility_probes.frag
out vec2 prediction;      // part of the light, and whether that is in doubt

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    Surface here = surface_at(at);
    float sum = 0.0, weights = 0.0, doubt = 0.0;
    for (int k = 0; k < 4; ++k) {
        Neighbour other = neighbour(k, at, here, PROBE_SPACING);
        vec2 found = fetch(around, other.at).xy;
        sum += other.weight * found.x;
        weights += other.weight;
        doubt = max(doubt, other.weight > 0.0 ? found.y : 0.0);
    }
    prediction = vec2(sum / weights, doubt);
}
