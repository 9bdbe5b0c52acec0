// The fraction of sample points, in a cone about the normal, that are not behind the visible surfaces.
#include "maths/octahedron.glsl"
#include "textures/half_resolution.glsl"
#include "maths/orthonormal_basis.glsl"
#include "maths/project.glsl"
#include "occlusion/radius.glsl"

uniform sampler2D depth;
uniform sampler2D position;
uniform usampler2D normal; // see surfaces/surface.glsl
uniform sampler2D random;
uniform vec3 directions[POINTS]; // in [0,1): two for the direction in the cone, one for the distance
uniform vec2 rotation; // of a sample: of the angle and of the distance
uniform float cone_sine;
uniform float attenuation;
out float raw_occlusion; // 1 is open

// Occlusion by the surface at point s on the screen. `subpixel_offset`: of this sample, from the pixels' centres.
float occlusion_by(vec3 p, vec3 geometric_normal, float radius, vec2 subpixel_offset, vec3 s) {
    vec3 screen = project(s);
    ivec2 at = ivec2(floor(screen.xy - subpixel_offset));
    if (screen.z <= 0.0 || any(lessThan(at, ivec2(0))) || any(greaterThan(at, last_pixel()))) return 0.0;
    if (fetch(depth, at).x >= -(view_from_anchor * vec4(s, 1.0)).z) return 0.0;
    vec3 offset = fetch(position, at).xyz - p;
    float square = dot(offset, offset) / (radius * radius);
    // Surfaces in the pixel's plane occlude nothing, nor do those further away than the radius.
    return square > 1.0 || dot(offset, geometric_normal) <= 0.02 * length(offset)
        ? 0.0 : 1.0 / (1.0 + attenuation * square);
}

void main() {
    ivec2 at = full_from_half(ivec2(gl_FragCoord.xy));
    vec4 receiver = fetch(position, at);
    raw_occlusion = 1.0;
    if (receiver.w == 0.0) return;
    uvec2 octahedra = fetch(normal, at).xy;
    vec3 n = direction_from_octahedron(unpack_octahedron(octahedra.x));
    vec3 geometric_normal = direction_from_octahedron(unpack_octahedron(octahedra.y));
    vec2 subpixel_offset = project(receiver.xyz).xy - (vec2(at) + 0.5);
    mat3 cone = basis(n);
    float occlusion = 0.0, radius = occlusion_radius(receiver.xyz);
    vec3 shift = vec3(0.0, fetch(random, ivec2(gl_FragCoord.xy) % TILE).xy + rotation);
    for (int k = 0; k < POINTS; ++k) {
        vec3 c = fract(directions[k] + shift);
        float sine = cone_sine * sqrt(c.x), angle = 6.283185307179586 * c.y;
        vec3 direction = cone * vec3(sine * cos(angle), sine * sin(angle), sqrt(1.0 - sine * sine));
        vec3 s = receiver.xyz + direction * radius * sqrt(c.z);
        occlusion += occlusion_by(receiver.xyz, geometric_normal, radius, subpixel_offset, s);
    }
    raw_occlusion = 1.0 - occlusion / float(POINTS);
}
