// The distance from each pixel to the nearest surface that casts shadows, along a random ray in a cone about the normal,
// distributed in proportion to the cosine.
#include "surfaces/surface.glsl"
#include "maths/orthonormal_basis.glsl"
#include "maths/rounding.glsl"
#include "sampling/cosine_hemisphere.glsl"
#include "sampling/pixel_sequence.glsl"
#include "trace/traversal.glsl"
uniform uvec2 first_ray; // of the first pixel's first sample, in the sequence over the picture
uniform uvec2 ray_steps;
uniform float cone_square; // square of the sine of half of the cone's angle
flat in float sample_index;
out float occlusion_distance; // m

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    Surface surface = surface_at(at);
    occlusion_distance = UNOCCLUDED;
    if (!surface.exists) return;
    vec2 uv = pixel_sequence(at, first_ray + uint(sample_index) * ray_steps);
    vec3 wi = basis(surface.normal) * cosine_hemisphere(vec2(uv.x * cone_square, uv.y));
    // Smooth normals lean beyond the triangle: what would be below its plane is reflected.
    float below = min(dot(wi, surface.geometric_normal), 0.0);
    wi -= 2.0 * below * surface.geometric_normal;
    vec3 p = surface.position + rounding(surface.position) * surface.geometric_normal;
    float reach = 2.0 * scene_extent.x; // beyond all surfaces
    float fraction = occluder_distance(p, p + reach * wi, surface.triangle, surface.instance);
    if (fraction < 1.0) occlusion_distance = min(fraction * reach, UNOCCLUDED);
}
