// What ambient occlusion leaves of the light at a pixel.
#include "occlusion/openness.glsl"
uniform float occlusion_intensity;
uniform float occlusion_power;
uniform vec3 occlusion_tint; // of full occlusion

struct Darkening { vec3 factor; vec3 correction; };

// The least base of the power's derivative, which is infinite at 0 for exponents below 1.
const float MIN_BASE = 0.01;

// By the open part of the surroundings, and what the factor changes with it.
vec2 left_by(float open) {
    float base = 1.0 - occlusion_intensity * (1.0 - open);
    float change = occlusion_power * occlusion_intensity * pow(max(base, MIN_BASE), occlusion_power - 1.0);
    return vec2(pow(clamp(base, 0.0, 1.0), occlusion_power), base > 0.0 ? change : 0.0);
}

Darkening darkening_at(ivec2 at, Surface surface) {
    vec2 open = openness_at(at, surface), left = left_by(open.x);
    vec3 range = 1.0 - occlusion_tint;
    return Darkening(occlusion_tint + range * left.x, range * left.y * (open.y - open.x));
}

// Darkens a prediction, with the most that its luminance can rise in alpha, and its residual, with the uncertain
// luminance in alpha. The correction is by other random numbers than the residual, so that of the product has their mean.
void darken(Darkening by, inout vec4 prediction, inout vec4 residual) {
    float light = luminance(prediction.rgb), most = max(by.factor.r, max(by.factor.g, by.factor.b));
    residual.rgb = residual.rgb * by.factor + (prediction.rgb + residual.rgb) * by.correction;
    residual.a *= most;
    prediction = vec4(by.factor, most) * prediction;
#if TRACED_OCCLUSION
    float left = luminance(prediction.rgb);
    residual.a += abs(left);
    prediction.a += max(light - left, 0.0) + (1.0 - most) * prediction.a / max(most, 1e-6);
#endif
}
