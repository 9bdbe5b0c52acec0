// One light on each pixel: what is predicted of it, and perhaps a ray that says how far that is wrong.
#include "lib/alike.glsl"
#include "lib/luminance.glsl"
#include "lib/receiver.glsl"
#include "lib/shadow_ray.glsl"
uniform samplerBuffer lights;
uniform int light_index;
uniform sampler2D prediction;
uniform sampler2D foreseen; // positions and normals of what was predicted
uniform sampler2D depth;
uniform vec2 shift; // of places on the light
uniform vec2 ray_steps;
uniform float enough; // change of luminance that is worth a ray
flat in float own_number;
flat in float own_sure;
layout(location = 0) out vec4 predicted; // in alpha, the luminance of what is in doubt, if none of it were hidden
#if RAYS
layout(location = 1) out vec4 correction;
layout(location = 2) out vec2 seen; // rays that arrived, and rays
#endif

// A prediction is of the surface that a pixel showed then. Of another one that it shows now, a neighbour may know.
vec2 known_of(Receiver here, ivec2 at) {
    ivec2 last = textureSize(prediction, 0) - 1;
#if RAYS
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
    return fetch(prediction, min(at, last)).xy;
#endif
}

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    predicted = vec4(0.0);
#if RAYS
    correction = vec4(0.0);
    seen = vec2(0.0);
#endif
    Receiver here = receiver_at(at);
    if (!here.seen) return;
    Light light = fetch_Light(lights, light_index);
    float full = receives(here, light) ? unshadowed_irradiance(light, here.position, here.normal) : 0.0;
    vec2 known = known_of(here, at);
    predicted = full * vec4(light.radiance * known.x, known.y > 0.0 ? luminance(light.radiance) : 0.0);
#if RAYS
    float bright = luminance(light.radiance * here.albedo) * full / 3.141592653589793;
    float doubt = known.y > 0.0 ? sqrt(max(known.x * (1.0 - known.x), 0.05)) : TRUST;
    float chance = own_sure > 0.0 ? own_sure : clamp(bright * doubt / enough, LEAST_CHANCE, 1.0);
    // Rays are numbered, so that they go through places that are spread evenly, however rare they are. Pixels close by take
    // turns together: processors work on several at once.
    float phase = place_of_pixel(at / 4, vec2(0.0)).x;
    // After each round of the places in the pixel at another time, or rays would only ever start at some of them.
    if (chance < 1.0) phase += floor(own_number / float(PLACES_IN_PIXEL)) * ray_steps.x;
    float number = floor(own_number * chance + phase);
    bool turn = floor((own_number + 1.0) * chance + phase) > number;
    if (full <= 0.0 || !(turn || own_sure > 0.0)) return;
    vec3 to = light.position + point_on_light(light, place_of_pixel(at, shift + number * ray_steps));
    float weight = sent(light, to - here.position, here.normal) / full;
    if (weight <= 0.0) return;
    seen = vec2(sees(here, to, light.blockers) ? 1.0 : 0.0, 1.0);
    if (own_sure > 0.0) return; // seen to tell whether there should be doubt: so rare, it would correct by far too much
    correction.rgb = light.radiance * (full * weight * (seen.x - known.x) / chance);
#endif
}
