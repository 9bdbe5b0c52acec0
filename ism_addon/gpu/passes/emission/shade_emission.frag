// Emission that the camera sees at the position of a pixel's sample.
#include "surfaces/emission.glsl"
uniform usampler2D normal; // see surfaces/surface.glsl
uniform sampler2D depth;
flat in vec4 visibility_texel_and_offset;
layout(location = 0) out vec4 sample_emission;

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    Ray ray = view_ray(gl_FragCoord.xy + visibility_texel_and_offset.zw);
    uvec2 id = fetch(normal, at).zw;
    Tint tint = tint_at(floor(gl_FragCoord.xy), visibility_texel_and_offset.xy);
    sample_emission = vec4(emission_along(ray, fetch(depth, at).x, int(id.x) - 1, int(id.y), tint), 0.0);
}
