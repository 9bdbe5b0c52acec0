// The rays to the world that trace_blocks has traced: where they start, their directions, and which were unoccluded.
#include "surfaces/surface.glsl"
#include "sampling/pixel_sequence.glsl"
#include "lights/light.glsl"
uniform sampler2D rays; // unoccluded, traced
uniform uvec2 light_uv; // of the first texel
uniform int world;      // row of LIGHT
uniform int spacing;    // px, from the pixel of a texel to that of the next
layout(location = 0) out vec4 start;     // in alpha, the relative radiance from there, or 0 if there is no ray
layout(location = 1) out vec4 direction; // in alpha, whether it was unoccluded

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    Surface surface = surface_at(min(spacing * at + spacing / 2, last_pixel()));
    vec2 counts = fetch(rays, at).xy;
    Light light = fetch_Light(scene_records, lights + world);
    LightSample from = light_sample(light, surface.position, surface.normal, pixel_sequence(at, light_uv));
    start = vec4(surface.position, surface.exists && counts.y > 0.0 ? max(from.radiance, 1e-6) : 0.0);
    direction = vec4(from.wi, counts.x);
}
