// The lobes of a pixel's surface other than Lambert's in the G-buffer: colors of up to 4, as 16-bit integers.
#include "maths/octahedron.glsl"
#include "materials/fresnel.glsl"

// Microfacets (GGX). Their reflectance is f0 at normal incidence, and rises by `schlick` and `dielectric` to grazing
// angles, along the curves of Schlick and of Fresnel's equations; metals change it by `edge` before.
struct Gloss {
    vec3 f0;
    vec3 schlick;
    vec3 dielectric;
    vec3 edge;
    float eta;
    float roughness;
    float reflected; // the fraction that the lobe reflects towards the camera, if microfacets reflect all
    float mean_rise; // how far the reflectance has risen by `schlick` and `dielectric`, for light from everywhere
    vec4 ltc;        // of the transform that makes the lobe a cosine: see materials/ltc.glsl
};

// What few materials have.
struct RareLobes {
    vec3 sheen;
    vec2 sheen_shape;       // see materials/rare_lobes.glsl
    float aspect;           // of the lobe that is not the coat: the root of alpha across the tangent over that along it
    float tangent_angle;    // of its tangent in the basis about the normal, in turns
    float diffuse_roughness;
    float diffuse_weight;   // by which the color of a rough diffuse lobe has been multiplied; 0: it reflects light once
    bool beckmann;          // whether microfacets of the lobe that is not the coat are distributed as by Beckmann
};

bool is_glossy(Gloss gloss) { return gloss.f0 + gloss.schlick + gloss.dielectric != vec3(0.0); }

const float MAX_REFLECTANCE = 4.0, MAX_SHEEN_SHAPE = 1.0; // of all that are stored

uvec4 pack_halves(vec4 low, vec4 high) {
    return uvec4(packUnorm2x16(low.xy), packUnorm2x16(low.zw), packUnorm2x16(high.xy), packUnorm2x16(high.zw));
}

mat2x4 unpack_halves(uvec4 bits) {
    return mat2x4(vec4(unpackUnorm2x16(bits.x), unpackUnorm2x16(bits.y)),
                  vec4(unpackUnorm2x16(bits.z), unpackUnorm2x16(bits.w)));
}

uvec4 pack_reflectance(Gloss gloss) {
    return pack_halves(vec4(gloss.f0 / MAX_REFLECTANCE, gloss.roughness),
                       vec4(gloss.schlick / MAX_REFLECTANCE, gloss.eta / (1.0 + gloss.eta)));
}

const float BITS_10 = 1023.0, BITS_14 = 16383.0;

// `bumps`: 0, or the normal without them, by `pack_smooth_normal`. Of `edge`, which changes the reflectance by a 17th of
// it at most, 10 bits of the fourth root are stored.
uvec4 pack_rise(Gloss gloss, uint bumps) {
    uvec3 edge = uvec3(sqrt(sqrt(clamp(gloss.edge / (7.0 * MAX_REFLECTANCE), 0.0, 1.0))) * BITS_10 + 0.5);
    return uvec4(packUnorm2x16(gloss.dielectric.xy / MAX_REFLECTANCE),
                 packUnorm2x16(vec2(gloss.dielectric.z / MAX_REFLECTANCE, gloss.reflected)),
                 edge.x | edge.y << 10u | edge.z << 20u | bumps << 30u,
                 uint(clamp(gloss.mean_rise, 0.0, 1.0) * BITS_14 + 0.5) | bumps >> 2u << 14u);
}

// 20 bits, not 0.
uint pack_smooth_normal(vec3 n) {
    uvec2 steps = uvec2((0.5 + 0.5 * octahedron_from_direction(n)) * (BITS_10 - 1.0) + 1.5);
    return steps.x | steps.y << 10u;
}

// The normal without bumps; `n`: with them, if there are any.
vec3 unpack_smooth_normal(uvec4 rise, vec3 n) {
    uint bumps = rise.z >> 30u | rise.w >> 14u << 2u;
    if (bumps == 0u) return n;
    vec2 steps = vec2(bumps & 1023u, bumps >> 10u);
    return direction_from_octahedron((steps - 1.0) / (0.5 * (BITS_10 - 1.0)) - 1.0);
}

const float LTC_RANGE = 4.01; // of entries of the table

uvec2 pack_ltc(vec4 entry) {
    vec4 unit = 0.5 + entry / LTC_RANGE;
    return uvec2(packUnorm2x16(unit.xy), packUnorm2x16(unit.zw));
}

vec4 unpack_ltc(uvec2 bits) { return LTC_RANGE * (vec4(unpackUnorm2x16(bits.x), unpackUnorm2x16(bits.y)) - 0.5); }

Gloss unpack_gloss(uvec4 reflectance, uvec4 rise, uvec2 ltc) {
    mat2x4 a = unpack_halves(reflectance);
    vec4 b = vec4(unpackUnorm2x16(rise.x), unpackUnorm2x16(rise.y));
    vec3 edge = vec3(rise.z & 1023u, rise.z >> 10u & 1023u, rise.z >> 20u & 1023u) / BITS_10;
    edge *= edge;
    return Gloss(MAX_REFLECTANCE * a[0].rgb, MAX_REFLECTANCE * a[1].rgb, MAX_REFLECTANCE * b.rgb,
                 7.0 * MAX_REFLECTANCE * edge * edge, a[1].w / max(1.0 - a[1].w, 1e-4), a[0].w, b.w,
                 float(rise.w & 16383u) / BITS_14, unpack_ltc(ltc));
}

// A coat is a dielectric whose reflectance rises to its weight, and has a normal of its own.
struct Coat { Gloss gloss; vec3 normal; };

uvec4 pack_coat(Coat coat) {
    vec3 weight = (coat.gloss.f0 + coat.gloss.dielectric) / MAX_REFLECTANCE;
    return pack_halves(vec4(weight, coat.gloss.roughness), vec4(coat.gloss.eta / (1.0 + coat.gloss.eta),
                       coat.gloss.reflected, 0.5 + 0.5 * octahedron_from_direction(coat.normal)));
}

Coat unpack_coat(uvec4 bits, uvec2 ltc) {
    mat2x4 a = unpack_halves(bits);
    float eta = a[1].x / max(1.0 - a[1].x, 1e-4), f0 = dielectric_f0(eta);
    vec3 weight = MAX_REFLECTANCE * a[0].rgb, none = vec3(0.0);
    Gloss gloss = Gloss(f0 * weight, none, (1.0 - f0) * weight, none, eta, a[0].w, a[1].y, 0.0, unpack_ltc(ltc));
    return Coat(gloss, direction_from_octahedron(2.0 * a[1].zw - 1.0));
}

// Of smooth sheen, which is faint except at silhouettes, 16 bits of its fourth root have three digits down to 1e-7.
uvec4 pack_rare_lobes(RareLobes rare) {
    vec2 bytes = floor(255.0 * clamp(vec2(rare.diffuse_roughness, rare.diffuse_weight), 0.0, 1.0) + 0.5);
    return pack_halves(vec4(sqrt(sqrt(rare.sheen / MAX_REFLECTANCE)), (256.0 * bytes.x + bytes.y) / 65535.0),
                       vec4(0.5 + rare.sheen_shape / (2.0 * MAX_SHEEN_SHAPE),
                            0.49 * (1.0 - rare.aspect) + (rare.beckmann ? 0.5 : 0.0), rare.tangent_angle));
}

RareLobes unpack_rare_lobes(uvec4 bits) {
    mat2x4 a = unpack_halves(bits);
    vec2 bytes = vec2(bits.y >> 24u, bits.y >> 16u & 255u) / 255.0;
    bool beckmann = a[1].z > 0.495;
    float aspect = 1.0 - (a[1].z - (beckmann ? 0.5 : 0.0)) / 0.49;
    vec3 root = a[0].rgb * a[0].rgb;
    return RareLobes(MAX_REFLECTANCE * root * root, 2.0 * MAX_SHEEN_SHAPE * (a[1].xy - 0.5), min(aspect, 1.0), a[1].w,
                     bytes.x, bytes.y, beckmann);
}
