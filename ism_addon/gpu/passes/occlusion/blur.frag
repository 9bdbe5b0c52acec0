// One axis of the separable filter: a triangle (tent) of seven pixels, weighted by the similarity of surfaces.
#include "textures/half_resolution.glsl"
#include "surfaces/surface.glsl"
uniform sampler2D occlusion;
uniform ivec2 along;
out float blurred_occlusion;

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy), last = last_pixel() / 2;
    Surface surface = surface_at(full_from_half(at));
    vec2 texel = texel_size(position), half_texel = texel_size(occlusion);
    float sum = fetch(occlusion, at).x * 4.0, weights = 4.0;
    for (int k = -3; k <= 3; ++k) {
        ivec2 neighbour = at + k * along;
        if (k == 0 || any(lessThan(neighbour, ivec2(0))) || any(greaterThan(neighbour, last))) continue;
        float weight = (4.0 - abs(float(k))) * similarity(surface, full_from_half(neighbour), texel);
        sum += weight * fetch(occlusion, neighbour, half_texel).x;
        weights += weight;
    }
    blurred_occlusion = sum / weights;
}
