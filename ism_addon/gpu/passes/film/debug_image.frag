// The texel of a target at each pixel: one component as grey, normals as colours, triangle indices as random colours.
#include "maths/octahedron.glsl"
#if INTEGERS
uniform usampler2D source;
uniform uvec3 triangle_steps;
uniform uvec3 instance_steps;
#else
uniform sampler2D source;
#endif
uniform int components;
uniform bool octahedral;
uniform ivec2 size; // of the region of the texture that the target covers, in texels
out vec4 color;

void main() {
    vec2 scale = vec2(size) / picture_size.xy;
    ivec2 at = min(ivec2(gl_FragCoord.xy * scale), size - 1);
#if INTEGERS
    uvec2 id = fetch(source, at).xy;
    color = id.x == 0u ? vec4(0.0) : vec4(vec3(id.x * triangle_steps + id.y * instance_steps) / 4294967296.0, 1.0);
#else
    vec4 texel = fetch(source, at);
    color.rgb = components < 3 ? texel.xxx : octahedral ? 0.5 + 0.5 * direction_from_octahedron(texel.xy) : texel.rgb;
    color.a = 1.0;
#endif
}
