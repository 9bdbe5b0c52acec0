// One ray from every fourth pixel.
#include "lib/receiver.glsl"
#include "lib/shadow_ray.glsl"
uniform sampler2D lights;
uniform int light_index;
uniform vec2 place;
out vec2 seen; // rays that arrived, and rays

void main() {
    ivec2 at = min(SCOUTS_APART * ivec2(gl_FragCoord.xy), textureSize(position, 0) - 1);
    seen = vec2(0.0);
    Receiver here = receiver_at(at);
    if (!here.seen) return;
    Light light = fetch_Light(lights, light_index);
    vec3 to = light.position + point_on_light(light, place_of_pixel(ivec2(gl_FragCoord.xy), place));
    if (sent(light, to - here.position, here.normal) <= 0.0) return;
    seen = vec2(sees(here, to) ? 1.0 : 0.0, 1.0);
}
