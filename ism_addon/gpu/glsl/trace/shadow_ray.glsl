// One shadow ray to a point of a light.
#include "trace/traversal.glsl"
#include "sampling/pixel_sequence.glsl"
#include "surfaces/surface.glsl"
#include "lights/light.glsl"
#include "maths/rounding.glsl"

// Cosine to a triangle's normal below which rays start on the curved surface that it approximates: Cycles' default.
const float GRAZING = 0.1;

float mean(vec3 color) { return (color.r + color.g + color.b) / 3.0; }

// Whether light arrives from a sample if nothing occludes it.
bool arrives(Surface surface, LightSample from) { return from.radiance > 0.0 && dot(surface.normal, from.wi) > 0.0; }

// The fraction of light that passes along the segment from a surface to a point of a light. At grazing angles it starts
// on the curved surface that the triangle approximates. The light may lie in the plane of a ceiling. For shadows the
// light may have another size: a shader variant for lights without sets SOFTNESS to 0.
vec3 shadow_transmittance(Surface surface, vec3 to, Light light) {
    vec3 p = surface.position;
#if SOFTNESS
    to = mix(light_centre(light, p, to), to, light.shadow_softness);
#endif
    vec3 direction = normalize(to - p);
    float smooth_cosine = abs(dot(surface.normal, direction)), cosine = dot(surface.geometric_normal, direction);
    float grazing = smooth_cosine < GRAZING ? 2.0 - (cosine + smooth_cosine) / GRAZING : 1.0 - cosine / GRAZING;
    p += surface.normal * (surface.terminator_offset * clamp(grazing, 0.0, 1.0));
    p += surface.geometric_normal * rounding(p);
    // The ray ends before the light by the rounding errors, but by at most half of the distance.
    to += light.normal * min(rounding(to) + rounding(p), 0.5 * dot(light.normal, p - to));
    // A ray that starts above its own triangle, downwards, can be occluded by it.
    int ignored = grazing > 0.0 && cosine <= 0.0 ? -1 : surface.triangle;
    return transmittance(p, to, ignored, surface.instance, light.blockers);
}
