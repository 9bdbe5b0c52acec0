// The mean of the predictions, plus the mean of the residuals, shrunk by their noise.
#include "maths/luminance.glsl"
uniform sampler2D sum_color;
uniform sampler2D sum_residual;
uniform sampler2D sum_weights;
uniform sampler2D sum_headroom;
uniform float min_light;          // minimum luminance
uniform sampler2D neighbour_mean; // see resolve_neighbours.frag
uniform sampler2D signal_and_noise;
out vec4 image;

// Factor of shrinkage, from a mean square and the noise in it.
float shrinkage(float square, float noise) { return square > 0.0 ? max(1.0 - noise / square, 0.0) : 1.0; }

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy), last = last_pixel();
    vec4 weights = fetch(sum_weights, at);
    image = fetch(sum_color, at) / weights.y;
#if HAS_RESIDUAL
    vec4 signal_sum = vec4(0.0);
    vec2 texel = texel_size(signal_and_noise);
    for (int y = -2; y <= 2; ++y) {
        for (int x = -2; x <= 2; ++x)
            signal_sum += fetch(signal_and_noise, clamp(at + ivec2(x, y), ivec2(0), last), texel);
    }
    vec3 mean = fetch(neighbour_mean, at).rgb, difference = fetch(sum_residual, at).rgb / weights.y - mean;
    vec3 change = shrinkage(signal_sum.z, signal_sum.w) * mean + shrinkage(signal_sum.x, signal_sum.y) * difference;
    // Residuals add at most the headroom. They remove at most the uncertain luminance, and at most what the pixel has.
    float amount = luminance(change);
    float max_change = (amount > 0.0 ? fetch(sum_headroom, at).x : weights.w) / weights.y;
    change *= min(max_change / max(abs(amount), 1e-37), 1.0);
    image.rgb = max(image.rgb + change, min(image.rgb, min_light));
#endif
}
