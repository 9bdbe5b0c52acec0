// One light on each pixel: what is predicted of it, and perhaps a ray that says how far that is wrong.
#include "surfaces/similarity.glsl"
#include "maths/luminance.glsl"
#include "surfaces/receiver.glsl"
#include "trace/ray_scheduling.glsl"
uniform samplerBuffer lights;
uniform int light_index;
uniform sampler2D prediction;
uniform sampler2D foreseen; // positions and normals of what was predicted
uniform sampler2D depth;
uniform uvec3 shift; // of places on the light, and of turns
flat in float own_chance;
layout(location = 0) out vec4 predicted; // in alpha, the luminance by which it would rise if all doubt were in vain
#if TRACE
layout(location = 1) out vec4 correction; // in alpha, the luminance of what is in doubt, if none of it were hidden
layout(location = 2) out vec2 seen; // rays that arrived, and rays
#endif

// A prediction is of the surface that a pixel showed then. Of another one that it shows now, a neighbour may know.
vec2 predicted_visibility_at(Receiver here, ivec2 at) {
#if TRACE
    ivec2 last = last_pixel();
    vec2 known = vec2(0.0, 1.0), texel = texel_size(foreseen);
    float z = fetch(depth, at).x, best = 0.0;
    for (int k = 0, taps = 9; k < taps; ++k) { // the pixel's own first
        ivec2 other = clamp(at + ivec2((k + 4) % 3 - 1, (k + 4) % 9 / 3 - 1), ivec2(0), last);
        float like = alike(here.position, here.normal, z, fetch(foreseen, other, texel));
        if (k == 0 || like > best) known = fetch(prediction, other, texel).xy;
        best = max(best, like);
        if (k == 0 && best > 0.5) taps = 1;
    }
    if (best < 0.5) known.y = 1.0;
    return known;
#else
    return fetch(prediction, min(at, textureSize(prediction, 0) - 1)).xy;
#endif
}

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    predicted = vec4(0.0);
#if TRACE
    correction = vec4(0.0);
    seen = vec2(0.0);
#endif
    Receiver here = receiver_at(at);
    if (!here.seen) return;
    Light light = fetch_Light(lights, light_index);
    float full = receives(here, light) ? unshadowed_irradiance(light, here.position, here.normal) : 0.0;
    vec2 known = predicted_visibility_at(here, at);
    float bright = luminance(light.radiance);
    predicted = full * vec4(light.radiance * known.x, known.y > 0.0 ? headroom(bright, known.x) : 0.0);
#if TRACE
    correction.a = known.y > 0.0 ? full * abs(bright) : 0.0;
    float chance = own_chance > 0.0 ? own_chance : ray_probability(light.radiance, here.albedo, full, known.x, known.y > 0.0);
    Turn turn = schedule_ray(at, shift.z, chance);
    if (full <= 0.0 || !(turn.now || own_chance > 0.0)) return;
    vec2 place = pixel_sequence(at, shift.xy + uint(turn.number) * ray_steps);
    LightSample sampled = sample_light(light, here.position, here.normal, place);
    if (sampled.irradiance <= 0.0) return;
    seen = vec2(sees(here, sampled.point, light) ? 1.0 : 0.0, 1.0);
    if (own_chance > 0.0) return; // seen to tell whether there should be doubt: so rare, it would correct by far too much
    correction.rgb = light.radiance * (sampled.irradiance * (seen.x - known.x) / turn.chance);
#endif
}
