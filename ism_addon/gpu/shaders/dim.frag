// A light that is a small part of what a block is lit by: the same part of it is predicted for all of the block's pixels.
#include "lib/luminance.glsl"
#include "lib/receiver.glsl"
#include "lib/shadow_ray.glsl"
uniform samplerBuffer lights;
uniform vec2 light_steps;
uniform vec2 ray_steps;
uniform float enough; // change of luminance that is worth a ray
flat in float own_number;
flat in float own_light;
flat in float own_sure; // the part that is thought to be seen
layout(location = 0) out vec4 predicted; // see trace.frag
layout(location = 1) out vec4 correction;

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    predicted = correction = vec4(0.0);
    Receiver here = receiver_at(at);
    if (!here.seen) return;
    Light light = fetch_Light(lights, int(own_light + 0.5));
    float full = receives(here, light) ? unshadowed_irradiance(light, here.position, here.normal) : 0.0, known = own_sure;
    predicted = full * vec4(light.radiance * known, 0.0);
#if RAYS
    if (light.casts_shadow == 0 || full <= 0.0) return;
    predicted.a = full * luminance(light.radiance); // of so few rays, none is proof
    float bright = luminance(light.radiance * here.albedo) * full / 3.141592653589793;
    float chance = clamp(bright * (known < 1.0 ? sqrt(max(known * (1.0 - known), 0.05)) : TRUST) / enough, LEAST_CHANCE, 1.0);
    vec2 own = fract((own_light + 1.0) * light_steps);
    float phase = place_of_pixel(at / 4, own).x + floor(own_number / float(PLACES_IN_PIXEL)) * ray_steps.x;
    float number = floor(own_number * chance + phase);
    if (floor((own_number + 1.0) * chance + phase) == number) return;
    vec3 to = light.position + point_on_light(light, place_of_pixel(at, own + number * ray_steps));
    float weight = sent(light, to - here.position, here.normal) / full;
    if (weight > 0.0) correction.rgb = light.radiance * (full * weight * ((sees(here, to, light.blockers) ? 1.0 : 0.0) - known) / chance);
#endif
}
