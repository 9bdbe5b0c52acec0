// A target's texel under the pixel: one component as grey, normals as colours, numbers of triangles as random colours.
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
uniform ivec2 size; // of the target's own part of it, in texels
out vec4 shown;

void main() {
    vec2 stretch = vec2(size) / picture_size.xy;
    ivec2 at = min(ivec2(gl_FragCoord.xy * stretch), size - 1);
#if INTEGERS
    uvec2 id = fetch(source, at).xy;
    shown = id.x == 0u ? vec4(0.0) : vec4(vec3(id.x * triangle_steps + id.y * instance_steps) / 4294967296.0, 1.0);
#else
    vec4 texel = fetch(source, at);
    shown = vec4(components < 3 ? texel.xxx : octahedral ? 0.5 + 0.5 * direction_from_octahedron(texel.xy) : texel.rgb, 1.0);
#endif
}
