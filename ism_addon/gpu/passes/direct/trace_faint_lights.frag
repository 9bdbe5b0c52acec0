// A light that is a small part of what a block is lit by: the same part of it is predicted for all of the block's pixels.
#include "maths/luminance.glsl"
#include "surfaces/receiver.glsl"
#include "trace/ray_scheduling.glsl"
uniform samplerBuffer lights;
uniform uvec3 light_steps;
flat in float own_light;
flat in float own_part;
flat in float own_chance;
layout(location = 0) out vec4 predicted; // see trace_shadows.frag
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
#if TRACE
    if (light.casts_shadow == 0 || full <= 0.0) return;
    correction.a = all * abs(bright);
    uvec3 own = (uint(own_light + 0.5) + 1u) * light_steps;
    float chance = ray_probability(light.radiance, here.albedo, all, known, known < 1.0);
    Turn turn = schedule_ray(at, own.z, max(chance, MIN_PROBABILITY / own_chance)); // as many rays as if it were always its turn
    if (!turn.now) return;
    vec2 place = pixel_sequence(at, own.xy + uint(turn.number) * ray_steps);
    LightSample sampled = sample_light(light, here.position, here.normal, place);
    if (sampled.irradiance <= 0.0) return;
    float seen = sees(here, sampled.point, light) ? 1.0 : 0.0;
    correction.rgb = light.radiance * (sampled.irradiance / own_chance * (seen - known) / turn.chance);
#endif
}
