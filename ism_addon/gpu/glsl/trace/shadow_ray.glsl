// One shadow ray to a point of a light.
#include "trace/traversal.glsl"
#include "surfaces/surface.glsl"
#include "lights/light.glsl"

// Cosine to a triangle below which the curved surface counts that it stands for: Cycles' default.
const float GRAZING = 0.1;

uniform uvec2 pixel_steps; // see sampling

// A pixel's member of a sequence over the picture: neighbours in tiles of 2, 4, 8 and 16 pixels have neighbouring members
// (in the order of Ahmed & Wonka 2020), so what they find on average is found by all of the light.
uint pixel_member(ivec2 at) {
    uvec2 bits = uvec2(at) & 1023u;
    bits = (bits | (bits << 8)) & 0x300ffu; // ten bits of each, interleaved
    bits = (bits | (bits << 4)) & 0xf0f0fu;
    bits = (bits | (bits << 2)) & 0x33333u;
    bits = (bits | (bits << 1)) & 0x55555u;
    return bits.x | (bits.y << 1);
}

// Numbers in [0,1) of 32-bit fixed point, whose sums wrap: what float32 would round away, or repeat, is kept.
vec2 unit_square(uvec2 number) { return vec2(number >> 8u) / 16777216.0; }

// The light_uv of one pixel, from that of the first.
vec2 pixel_sequence(ivec2 at, uvec2 light_uv) { return unit_square(light_uv + pixel_member(at) * pixel_steps); }

// Whether a point of a light sends any light to a surface that nothing hides.
bool arrives(Surface surface, LightSample from) { return from.radiance > 0.0 && dot(surface.normal, from.wi) > 0.0; }

// Rounding may put a point off its surface by this, m: to what lies on the surface, it must not be on the other side.
float rounding(vec3 p) { return 1e-6 * (abs(p.x) + abs(p.y) + abs(p.z)); }

// Where light no longer comes from well above the triangle, a ray starts on the curved surface that it stands for. A light
// may lie in a ceiling.
bool is_unoccluded(Surface surface, vec3 to, Light light) {
    vec3 p = surface.position, direction = normalize(to - p);
    float smooth_cosine = abs(dot(surface.normal, direction)), cosine = dot(surface.geometric_normal, direction);
    float grazing = smooth_cosine < GRAZING ? 2.0 - (cosine + smooth_cosine) / GRAZING : 1.0 - cosine / GRAZING;
    p += surface.normal * (surface.terminator_offset * clamp(grazing, 0.0, 1.0));
    p += surface.geometric_normal * rounding(p);
    // A ray ends as exactly as it is known where it starts; a light may be closer to what it lights than that.
    to += light.normal * min(rounding(to) + rounding(p), 0.5 * dot(light.normal, p - to));
    return !any_hit(p, to, surface.triangle, surface.instance, light.blockers);
}
