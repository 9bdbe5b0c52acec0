// What a graph's shaders add up to.
#include "nodes/point.glsl"

// The sums of glossy shaders, see materials/gloss.glsl; of roughness and eta they are weighted, by the sums beside them.
struct GlossyClosures {
    vec3 f0;
    vec3 schlick;
    vec3 dielectric;
    vec3 edge;
    float roughness;
    float roughness_weight;
    float eta;
    float eta_weight;
};

struct Closures {
    vec3 transparency;
    float pass_limit; // of pass_probability
    vec3 emission;
    vec3 diffuse;
    float diffuse_roughness; // weighted by what diffuse shaders reflect
    float diffuse_weight;    // likewise: weights of the rough shaders that reflect light more than once
    vec3 normal;             // sum of the shaders' normals, weighted by what they reflect
    GlossyClosures glossy;
    float aspect; // of microfacets, at most 1: see materials/gloss.glsl
    bool beckmann; // whether these are distributed as by Beckmann
    vec3 tangent;
    GlossyClosures coat;
    vec3 coat_normal;
    vec3 sheen;
    vec2 sheen_shape; // see materials/rare_lobes.glsl
    bool shadows_bumps; // see materials/bump_shadowing.glsl
};

Closures no_closures() {
    GlossyClosures none = GlossyClosures(vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), 0.0, 0.0, 0.0, 0.0);
    vec3 zero = vec3(0.0);
    return Closures(zero, 1.0, zero, zero, 0.0, 0.0, zero, none, 1.0, false, zero, none, zero, zero, vec2(0.0),
                    false);
}

void closure_transparent(inout Closures closures, ShadingPoint at, vec3 color) {
    closures.transparency += max(color, 0.0);
}

void closure_pass_limit(inout Closures closures, ShadingPoint at, float limit) { closures.pass_limit = limit; }

// That a camera ray passes, for the fractions that do: what it sees then is multiplied by tints of 1 at most, if there is
// no limit in alpha.
float pass_probability(vec4 passes) { return min(max(passes.r, max(passes.g, passes.b)), passes.a); }

void closure_emission(inout Closures closures, ShadingPoint at, vec3 radiance) { closures.emission += radiance; }

float sum_of(vec3 color) { return color.r + color.g + color.b; }

const float MAX_COLOR = 1e9, MAX_RADIANCE = 1e15; // as of constants and of worlds, see scene/limits.py

// Black in place of what is no number or too large: other pixels are filtered with this one. Cycles draws it black, too.
vec3 finite(vec3 color, float limit) { return mix(vec3(0.0), color, lessThanEqual(abs(color), vec3(limit))); }
vec3 finite(vec3 color) { return finite(color, MAX_COLOR); }

void closure_diffuse(inout Closures closures, ShadingPoint at, vec3 reflectance, vec3 normal) {
    vec3 reflected = finite(max(reflectance, 0.0));
    closures.diffuse += reflected;
    closures.normal += sum_of(reflected) * normal;
}

void closure_bump_shadowing(inout Closures closures, ShadingPoint at, vec3 normal, int function) {
    closures.shadows_bumps = true;
}

// Rough as by Oren & Nayar 1994, with the light that is reflected several times or without it.
void closure_rough_diffuse(inout Closures closures, ShadingPoint at, vec3 weight, vec3 color, float roughness,
                           vec3 normal, int multiple) {
    float reflected = sum_of(finite(max(weight * color, 0.0)));
    closure_diffuse(closures, at, weight * color, normal);
    closures.diffuse_roughness += reflected * clamp(roughness, 0.0, 1.0);
    if (multiple == 1) closures.diffuse_weight += reflected * sum_of(weight) / 3.0;
}
