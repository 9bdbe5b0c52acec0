// Emission that the camera sees at a position of each pixel, by a camera ray. Filters also cover pixels around the
// picture.
#include "trace/traversal.glsl"
#include "surfaces/emission.glsl"
uniform vec2 depths; // at which camera rays start and end, m
flat in vec4 visibility_texel_and_offset;
layout(location = 0) out vec4 subsample_emission;

void main() {
    Ray ray = view_ray(gl_FragCoord.xy - float(BORDER) + visibility_texel_and_offset.zw);
    Intersection hit = nearest_hit(ray.origin + depths.x * ray.direction, ray.origin + depths.y * ray.direction);
    float depth = mix(depths.x, depths.y, hit.distance);
    subsample_emission = vec4(emission_along(ray, depth, hit.triangle, hit.instance, NO_TINT), 0.0);
}
