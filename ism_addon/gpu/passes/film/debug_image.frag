// The texel of a target at each pixel: one component as grey, normals as colours, triangle indices as random colours.
#include "maths/octahedron.glsl"
#if INTEGERS
uniform usampler2D source; // see surfaces/surface.glsl
uniform bool primitive;    // which is shown, and not the normal
uniform uvec3 triangle_steps;
uniform uvec3 instance_steps;
#else
uniform sampler2D source;
uniform int components;
#endif
uniform ivec2 size; // of the region of the texture that the target covers, in texels
out vec4 color;

void main() {
    vec2 scale = vec2(size) / picture_size.xy;
    ivec2 at = min(ivec2(gl_FragCoord.xy * scale), size - 1);
#if INTEGERS
    uvec4 ids = fetch(source, at);
    vec3 random = vec3(ids.z * triangle_steps + ids.w * instance_steps) / 4294967296.0;
    vec3 direction = 0.5 + 0.5 * direction_from_octahedron(unpack_octahedron(ids.x));
    color = ids.z == 0u ? vec4(0.0) : vec4(primitive ? random : direction, 1.0);
#else
    vec4 texel = fetch(source, at);
    color = vec4(components < 3 ? texel.xxx : texel.rgb, 1.0);
#endif
}
