// One shadow ray to a place on a light.
#include "lib/occluded.glsl"
#include "lib/receiver.glsl"
#include "lib/spread.glsl"

// Cosine to a triangle below which the curved surface counts that it stands for: Cycles' default.
const float GRAZING = 0.1;

uniform vec2 pixel_steps; // see sampling.py

// The place for one pixel: neighbours in blocks of 2, 4, 8 and 16 pixels have neighbouring members of a sequence (in the
// order of Ahmed & Wonka 2020), so what they find on average is found by all of the light.
vec2 place_of_pixel(ivec2 at, vec2 place) {
    uvec2 bits = uvec2(at) & 63u;
    bits = (bits | (bits << 4)) & 0x30fu; // six bits of each, interleaved
    bits = (bits | (bits << 2)) & 0x333u;
    bits = (bits | (bits << 1)) & 0x555u;
    float member = float(bits.x | (bits.y << 1));
    return fract(place + member * pixel_steps);
}

// The point of the light, from its position, that a place of the unit square stands for: equal areas.
vec3 point_on_light(Light light, vec2 place) {
    if (light.shape == 0) return (place.x - 0.5) * light.axis_u + (place.y - 0.5) * light.axis_v;
    float radius = 0.5 * sqrt(place.x), angle = 6.283185307179586 * place.y;
    return radius * (cos(angle) * light.axis_u + sin(angle) * light.axis_v);
}

// What the light would send if all of it were as near, as tilted and as bright as this point of it.
float sent(Light light, vec3 ray, vec3 n) {
    float square = max(dot(ray, ray), 1e-30), inverse = inversesqrt(square);
    float ahead = max(-dot(light.normal, ray) * inverse, 0.0);
    float area = length(cross(light.axis_u, light.axis_v)) * (light.shape == 0 ? 1.0 : 0.7853981633974483);
    return area * max(dot(n, ray) * inverse, 0.0) * ahead * spread(light, ahead) / square;
}

// Rounding may put a point off its surface by this, m: to what lies on the surface, it must not be on the other side.
float rounding(vec3 p) { return 1e-6 * (abs(p.x) + abs(p.y) + abs(p.z)); }

// Where light no longer comes from well above the triangle, a ray starts on the curved surface that it stands for. A light
// may lie in a ceiling.
bool sees(Receiver here, vec3 to, Light light) {
    vec3 p = here.position, direction = normalize(to - p);
    float smooth_cosine = abs(dot(here.normal, direction)), cosine = dot(here.facet, direction);
    float grazing = smooth_cosine < GRAZING ? 2.0 - (cosine + smooth_cosine) / GRAZING : 1.0 - cosine / GRAZING;
    p += here.normal * (here.rise * clamp(grazing, 0.0, 1.0));
    p += here.facet * rounding(p);
    // A ray ends as exactly as it is known where it starts; a light may be closer to what it lights than that.
    to += light.normal * min(rounding(to) + rounding(p), 0.5 * dot(light.normal, p - to));
    return !occluded(p, to, here.triangle, here.instance, light.blockers);
}
