// The part of a cone of points about the normal that is not behind what the camera sees.
#include "maths/octahedron.glsl"
#include "textures/half_resolution.glsl"
#include "maths/orthonormal_basis.glsl"

uniform sampler2D depth;
uniform sampler2D position;
uniform sampler2D normal;
uniform sampler2D random;
uniform vec3 directions[POINTS]; // in [0,1): two for the place on the cone's cap, one for the distance
uniform vec2 rotation; // of a sample: of the angle and of the distance
uniform float radius;
uniform float cone_sine;
uniform float intensity;
uniform float attenuation;
out float raw_occlusion; // 1 is open

// In pixels, and whether it is ahead at all.
vec3 project(vec3 p) {
    vec4 clip = clip_from_anchor * vec4(p, 1.0);
    return vec3((0.5 * clip.xy / clip.w + 0.5) * picture_size.xy, clip.w);
}

// `subpixel_offset`: of this sample, from the pixels' centres.
float occlusion_by(vec3 p, vec3 geometric_normal, vec2 subpixel_offset, vec3 s) {
    vec3 screen = project(s);
    ivec2 at = ivec2(floor(screen.xy - subpixel_offset));
    if (screen.z <= 0.0 || any(lessThan(at, ivec2(0))) || any(greaterThan(at, last_pixel()))) return 0.0;
    if (fetch(depth, at).x >= -(view_from_anchor * vec4(s, 1.0)).z) return 0.0;
    vec3 to = fetch(position, at).xyz - p;
    float square = dot(to, to) / (radius * radius);
    // What lies in the pixel's own plane occludes nothing; what is far in front of it is not a neighbour.
    return square > 1.0 || dot(to, geometric_normal) <= 0.02 * length(to) ? 0.0 : 1.0 / (1.0 + attenuation * square);
}

void main() {
    ivec2 at = full_from_half(ivec2(gl_FragCoord.xy));
    vec4 here = fetch(position, at);
    raw_occlusion = 1.0;
    if (here.w == 0.0) return;
    vec4 octahedra = fetch(normal, at);
    vec3 n = direction_from_octahedron(octahedra.xy), geometric_normal = direction_from_octahedron(octahedra.zw);
    vec2 subpixel_offset = project(here.xyz).xy - (vec2(at) + 0.5);
    mat3 cone = basis(n);
    vec3 shift = vec3(0.0, fetch(random, ivec2(gl_FragCoord.xy) % TILE).xy + rotation);
    float hidden = 0.0;
    for (int k = 0; k < POINTS; ++k) {
        vec3 c = fract(directions[k] + shift);
        float sine = cone_sine * sqrt(c.x), angle = 6.283185307179586 * c.y;
        vec3 direction = cone * vec3(sine * cos(angle), sine * sin(angle), sqrt(1.0 - sine * sine));
        hidden += occlusion_by(here.xyz, geometric_normal, subpixel_offset, here.xyz + direction * radius * sqrt(c.z));
    }
    raw_occlusion = clamp(1.0 - intensity * hidden / float(POINTS), 0.0, 1.0);
}
