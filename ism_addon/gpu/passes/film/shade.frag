// Composition in linear light.
#include "textures/bilateral_upsample.glsl"
#include "maths/luminance.glsl"
uniform sampler2D albedo;
uniform sampler2D irradiance; // by shadow maps
uniform sampler2D predicted;  // or by rays
uniform sampler2D correction; // and what they find wrong
uniform sampler2D occlusion;
uniform vec3 world;
uniform float background;
layout(location = 0) out vec4 color;
layout(location = 1) out vec4 color_correction; // in alpha, the luminance that is in doubt
layout(location = 2) out float headroom;        // and that by which the picture would rise without doubt

// Of the world's light. Occlusion is at half resolution.
float ambient_visibility(ivec2 at, Surface here) {
#if OCCLUDED
    float sum = 0.0, weights = 0.0;
    for (int k = 0; k < 4; ++k) {
        Neighbour other = neighbour(k, at, here, 2);
        sum += other.weight * fetch(occlusion, other.at).x;
        weights += other.weight;
    }
    return sum / weights;
#else
    return 1.0;
#endif
}

// Of a target that is a few texels, all alike, where nobody draws it.
vec4 fetch_clamped(sampler2D target, ivec2 at) { return fetch(target, min(at, textureSize(target, 0) - 1)); }

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    Surface here = surface_at(at);
    color_correction = vec4(0.0);
    headroom = 0.0;
    if (!here.seen) {
        color = background * vec4(world, 1.0);
        return;
    }
    // A Lambertian surface sends its albedo's part of what arrives, spread over pi; from a world of one radiance
    // arrives pi times that.
    vec3 part = fetch(albedo, at).rgb, sent = part / 3.141592653589793;
    vec4 expected = fetch_clamped(predicted, at);
    color = vec4(sent * (fetch_clamped(irradiance, at).rgb + expected.rgb) + part * world * ambient_visibility(at, here), 1.0);
    color_correction = vec4(sent, luminance(sent)) * fetch_clamped(correction, at);
    headroom = luminance(sent) * expected.a;
}
