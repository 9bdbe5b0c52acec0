// A light that is a small part of what a block is lit by: the same part of it is predicted for all of the block's pixels.
#include "lib/luminance.glsl"
#include "lib/receiver.glsl"
#include "lib/turn.glsl"
uniform samplerBuffer lights;
uniform vec2 light_steps;
flat in float own_light;
flat in float own_part;
flat in float own_chance;
layout(location = 0) out vec4 predicted; // see trace.frag
layout(location = 1) out vec4 correction;

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    predicted = correction = vec4(0.0);
    Receiver here = receiver_at(at);
    if (!here.seen) return;
    Light light = fetch_Light(lights, int(own_light + 0.5));
    float full = receives(here, light) ? unshadowed_irradiance(light, here.position, here.normal) : 0.0, known = own_part;
    float all = full / own_chance; // the rarer its turn, the more it counts
    float bright = luminance(light.radiance); // all of it in doubt: of so few rays, none is proof
    predicted = all * vec4(light.radiance * known, light.casts_shadow == 0 ? 0.0 : headroom(bright, known));
#if RAYS
    if (light.casts_shadow == 0 || full <= 0.0) return;
    correction.a = all * abs(bright);
    vec2 own = fract((own_light + 1.0) * light_steps);
    float chance = chance_of(light.radiance, here.albedo, all, known, known < 1.0);
    Turn turn = turn_of(at, own, max(chance, LEAST_CHANCE / own_chance)); // as many rays as if it were always its turn
    if (!turn.now) return;
    vec3 to = light.position + point_on_light(light, place_of_pixel(at, own + turn.number * ray_steps));
    float weight = sent(light, to - here.position, here.normal) / full;
    if (weight <= 0.0) return;
    float seen = sees(here, to, light) ? 1.0 : 0.0;
    correction.rgb = light.radiance * (all * weight * (seen - known) / turn.chance);
#endif
}
