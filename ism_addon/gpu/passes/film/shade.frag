// Composition in linear light.
#include "maths/luminance.glsl"
#include "surfaces/tint.glsl"
#include "surfaces/surface.glsl"
#if OCCLUSION
#include "occlusion/darkening.glsl"
#endif
#if GLOSS
#include "surfaces/camera_ray.glsl"
#include "materials/lobes.glsl"
#endif
uniform sampler2D direct_prediction;
uniform sampler2D direct_residual;
#if SEPARATE_WORLD
uniform sampler2D world_prediction;
uniform sampler2D world_residual;
#endif
uniform sampler2D background; // a few black texels, unless the radiance of the world varies
uniform vec3 even_background;
uniform vec3 ambient; // the world's radiance, if it is not one of the lights
uniform float film;   // 0 if the background is transparent
flat in vec4 visibility_texel_and_offset;
layout(location = 0) out vec4 sample_color;
layout(location = 1) out vec4 sample_residual;  // in alpha, the uncertain luminance
layout(location = 2) out float sample_headroom; // upper bound of the increase of luminance

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
    vec4 prediction = fetch_clamped(direct_prediction, at), residual = fetch_clamped(direct_residual, at);
    // A surface reflects the fraction of its albedo of a world of constant radiance.
    vec3 albedo = surface.base_color;
#if GLOSS
    Lobes lobes = lobes_at(at, surface, direction_to_camera(surface.position));
    albedo += reflected_fraction(lobes);
#if RARE_LOBES
    albedo += lobes.rare.sheen;
#endif
#endif
    vec4 of_world = vec4(albedo * ambient, 0.0), residual_of_world = vec4(0.0);
#if SEPARATE_WORLD
    of_world += fetch(world_prediction, at);
    residual_of_world = fetch_clamped(world_residual, at);
#endif
#if OCCLUSION
    Darkening darkening = darkening_at(at, surface);
#if DARKENS_ALL
    of_world += prediction;
    residual_of_world += residual;
    prediction = residual = vec4(0.0);
#endif
    darken(darkening, of_world, residual_of_world);
#endif
    prediction += of_world;
    residual += residual_of_world;
    sample_color = vec4(tint * prediction.rgb, 1.0);
    float brightest = max(tint.r, max(tint.g, tint.b)); // by which luminance grows at most
    sample_residual = vec4(tint, brightest) * residual;
    sample_headroom = brightest * prediction.a;
}
