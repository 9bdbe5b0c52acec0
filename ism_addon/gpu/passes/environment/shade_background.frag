// What the camera sees of the world at the position of a pixel's sample, where no surface is.
#include "surfaces/camera_ray.glsl"
#include "surfaces/node_graph.glsl"
flat in vec4 visibility_texel_and_offset;
flat in float sample_index;
uniform sampler2D depth;
uniform int first_constant;
out vec4 background;

vec3 direction_at(vec2 pixel) { return normalize(view_ray(pixel).direction); }

void main() {
    background = vec4(0.0);
    if (fetch(depth, ivec2(gl_FragCoord.xy)).x < BACKGROUND_DEPTH) return;
    vec2 pixel = gl_FragCoord.xy + visibility_texel_and_offset.zw;
    vec3 d = direction_at(pixel);
    // Footprints shrink with the number of samples, as in gbuffer.frag.
    float scale = inversesqrt(1.0 + sample_index);
    vec2 step = scale / picture_size.xy;
    Shift dx = Shift(scale * (direction_at(pixel + vec2(1.0, 0.0)) - d), vec3(step.x, 0.0, 0.0));
    Shift dy = Shift(scale * (direction_at(pixel + vec2(0.0, 1.0)) - d), vec3(0.0, step.y, 0.0));
    ShadingPoint at = ShadingPoint(d, vec3(pixel / picture_size.xy, 0.0), -d, -d, -d, false, 0, 0);
    Shift none = Shift(vec3(0.0), vec3(0.0));
    Closures closures = evaluate_graph(at, Differentials(dx, dy, none, none), first_constant);
    background.rgb = finite(closures.emission, MAX_RADIANCE);
}
