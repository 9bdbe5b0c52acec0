// Ambient occlusion, blended with that of the last views, where these showed the same surface.
#include "surfaces/surface.glsl"
#include "occlusion/openness.glsl"
uniform bool has_last;
uniform sampler2D last_occlusion; // blended, over how many views
uniform sampler2D last_position;  // in alpha, the normal, packed
uniform mat4 last_clip_from_anchor;
uniform vec3 anchor_change; // from the last view's anchor to this one, m
uniform bool is_same_view;
layout(location = 0) out vec2 steady_occlusion; // as traced_occlusion
layout(location = 1) out vec2 blended;          // over how many views

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    Surface surface = surface_at(at);
    steady_occlusion = openness_at(at, surface);
    blended = vec2(steady_occlusion.x, 1.0);
    if (!has_last) return;
    if (is_same_view) {
        blended = fetch(last_occlusion, at).xy;
        steady_occlusion.x = blended.x;
        return;
    }
    vec3 p = surface.position + anchor_change;
    vec4 clip = last_clip_from_anchor * vec4(p, 1.0);
    vec2 pixel = (0.5 * clip.xy / clip.w + 0.5) * picture_size.xy - 0.5, corner = floor(pixel), part = pixel - corner;
    vec2 sum = vec2(0.0);
    float weights = 0.0;
    for (int k = 0; k < 4; ++k) {
        ivec2 step = ivec2(k & 1, k >> 1), from = ivec2(corner) + step;
        if (clip.w <= 0.0 || any(lessThan(from, ivec2(0))) || any(greaterThan(from, last_pixel()))) continue;
        vec2 bilinear = mix(1.0 - part, part, vec2(step));
        float weight = bilinear.x * bilinear.y * similarity(p, surface.normal, surface.depth, fetch(last_position, from));
        sum += weight * fetch(last_occlusion, from).xy;
        weights += weight;
    }
    if (!surface.exists || weights < MIN_WEIGHT) return;
    vec2 before = sum / weights;
    float views = min(before.y + 1.0, MAX_VIEWS);
    blended = vec2(mix(before.x, steady_occlusion.x, 1.0 / views), views);
    steady_occlusion.x = blended.x;
}
