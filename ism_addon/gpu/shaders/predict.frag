// What part of a light a pixel sees: between the pixels that scouted, as far as they show the surface that is here.
#include "lib/surface.glsl"
uniform sampler2D around; // see predict_scouts.frag
out vec2 prediction;      // part of the light, and whether that is in doubt

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy), size = textureSize(position, 0), last = textureSize(around, 0) - 1;
    Surface here = surface_at(at);
    vec2 offset = vec2(at % SCOUTS_APART) / float(SCOUTS_APART);
    float sum = 0.0, weights = 0.0, doubt = 0.0;
    for (int k = 0; k < 4; ++k) {
        ivec2 step = ivec2(k & 1, k >> 1), other = min(at / SCOUTS_APART + step, last);
        vec2 found = texelFetch(around, other, 0).xy, near = mix(1.0 - offset, offset, vec2(step));
        float weight = near.x * near.y * (alike(here, min(SCOUTS_APART * other, size - 1)) + 1e-4);
        sum += weight * found.x;
        weights += weight;
        doubt = max(doubt, weight > 0.0 ? found.y : 0.0);
    }
    prediction = vec2(sum / weights, doubt);
}
