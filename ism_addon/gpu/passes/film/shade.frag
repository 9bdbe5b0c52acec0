// Composition in linear light.
#include "surfaces/tint.glsl"
#include "textures/bilateral_upsample.glsl"
#if GLOSS
#include "surfaces/camera_ray.glsl"
#include "materials/lobes.glsl"
#endif
uniform sampler2D direct_prediction;
uniform sampler2D direct_residual;
uniform sampler2D ambient_occlusion;
uniform float occlusion_intensity;
uniform float occlusion_power;
uniform sampler2D background; // a few black texels, unless the radiance of the world varies
uniform vec3 even_background;
uniform vec3 ambient; // the world's radiance, if it is not one of the lights
uniform float film;   // 0 if the background is transparent
flat in vec4 visibility_texel_and_offset;
layout(location = 0) out vec4 sample_color;
layout(location = 1) out vec4 sample_residual;  // in alpha, the uncertain luminance
layout(location = 2) out float sample_headroom; // upper bound of the increase of luminance

// Visibility of the world. Ambient occlusion has half resolution.
float ambient_visibility(ivec2 at, Surface surface) {
#if OCCLUDED
    float sum = 0.0, weights = 0.0;
    for (int k = 0; k < 4; ++k) {
        UpsampleTap other = upsample_tap(k, at, surface, 2);
        sum += other.weight * fetch(ambient_occlusion, other.at).x;
        weights += other.weight;
    }
    return pow(clamp(1.0 - occlusion_intensity * (1.0 - sum / weights), 0.0, 1.0), occlusion_power);
#else
    return 1.0;
#endif
}

// Fetches a target that is a few neutral texels if no pass draws it.
vec4 fetch_clamped(sampler2D target, ivec2 at) { return fetch(target, min(at, textureSize(target, 0) - 1)); }

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    Surface surface = surface_at(at);
    vec3 tint = tint_at(floor(gl_FragCoord.xy), visibility_texel_and_offset.xy).color;
    sample_residual = vec4(0.0);
    sample_headroom = 0.0;
    if (!surface.exists) { // without a world, tints cover what is behind the picture
        float opaque = 1.0 - (tint.r + tint.g + tint.b) / 3.0;
        vec3 world = even_background + fetch_clamped(background, at).rgb;
        sample_color = vec4(film * tint * world, mix(opaque, 1.0, film));
        return;
    }
    vec4 direct = fetch_clamped(direct_prediction, at);
    // A surface reflects the fraction of its albedo of a world of constant radiance.
    vec3 albedo = surface.base_color;
#if GLOSS
    Lobes lobes = lobes_at(at, surface, direction_to_camera(surface.position));
    albedo += reflected_fraction(lobes);
#if RARE_LOBES
    albedo += lobes.rare.sheen;
#endif
#endif
    sample_color = vec4(tint * (direct.rgb + albedo * ambient * ambient_visibility(at, surface)), 1.0);
    float brightest = max(tint.r, max(tint.g, tint.b)); // by which luminance grows at most
    sample_residual = vec4(tint, brightest) * fetch_clamped(direct_residual, at);
    sample_headroom = brightest * direct.a;
}
