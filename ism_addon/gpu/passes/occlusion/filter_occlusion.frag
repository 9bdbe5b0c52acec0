// The visible fraction of the hemisphere by the rays of a pixel and of its neighbours on the same surface: an a-trous
// filter (Dammertz et al. 2010) of 3 by 3 pixels a level. And the visibility by the pixel's own ray.
#include "surfaces/surface.glsl"
#include "occlusion/radius.glsl"
uniform sampler2D distances; // of the first level; else the level before
uniform int spacing;         // px
uniform float attenuation;
out vec2 traced_occlusion;   // filtered, of the own ray; 1 is open

// By the ray of a pixel at a point, or what the level before gives for it.
vec2 openness(ivec2 at, vec2 texel, float radius) {
#if FIRST_LEVEL
    float part = fetch(distances, at, texel).x / radius;
    return vec2(part < 1.0 ? 1.0 - pow(max(1.0 - part * part, 1e-6), attenuation) : 1.0);
#else
    return fetch(distances, at, texel).xy;
#endif
}

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy), last = last_pixel();
    Surface surface = surface_at(at);
    traced_occlusion = vec2(1.0);
    if (!surface.exists) return;
    vec2 texel = texel_size(distances), surface_texel = texel_size(position);
    float radius = occlusion_radius(surface.position);
    vec2 own = openness(at, texel, radius);
    float sum = 4.0 * own.x, weights = 4.0;
    for (int k = 0; k < 9; ++k) {
        ivec2 step = ivec2(k % 3, k / 3) - 1, other = at + spacing * step;
        if (step == ivec2(0) || any(lessThan(other, ivec2(0))) || any(greaterThan(other, last))) continue;
        float weight = float((2 - abs(step.x)) * (2 - abs(step.y))) * similarity(surface, other, surface_texel);
        sum += weight * openness(other, texel, radius).x;
        weights += weight;
    }
    traced_occlusion = vec2(sum / weights, own.y);
}
