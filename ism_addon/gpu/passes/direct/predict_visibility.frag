// Predicted visibility of a light at a pixel: a bilateral interpolation of the predictions at probes.
#include "textures/bilateral_upsample.glsl"
uniform sampler2D probe_prediction; // see predict_visibility_probes.frag
out vec2 prediction;                // visibility, whether it is uncertain

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    Surface surface = surface_at(at);
    float sum = 0.0, weights = 0.0, uncertain = 0.0;
    for (int k = 0; k < 4; ++k) {
        UpsampleTap other = upsample_tap(k, at, surface, PROBE_SPACING);
        vec2 predicted = fetch(probe_prediction, other.at).xy;
        sum += other.weight * predicted.x;
        weights += other.weight;
        uncertain = max(uncertain, other.weight > 0.0 ? predicted.y : 0.0);
    }
    prediction = vec2(sum / weights, uncertain);
}
