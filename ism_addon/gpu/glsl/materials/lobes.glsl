// All lobes of a surface but Lambert's: microfacets, a coat of others above them, and rare ones.
#include "maths/orthonormal_basis.glsl"
#include "maths/pi.glsl"
#include "surfaces/surface.glsl"
#include "materials/gloss.glsl"
#include "materials/rare_lobes.glsl"
#include "materials/bump_shadowing.glsl"
uniform usampler2D gloss_reflectance;
uniform usampler2D gloss_rise;
uniform usampler2D ltc_entries; // of the lobe, and of the coat
#if COAT
uniform usampler2D coat;
#endif
#if RARE_LOBES
uniform usampler2D rare_lobes;
#endif

struct Lobes {
    vec3 normal;
    vec3 wo; // unit vector to the camera
    Gloss gloss;
    Microfacets facets;
#if COAT
    Gloss coat;
    Microfacets coat_facets;
#endif
#if RARE_LOBES
    RareLobes rare;
#endif
#if BUMPS
    vec3 smooth_normal; // of the surface without bumps
#endif
    vec3 base_color;
    bool exist;
    bool change_diffuse; // whether they include a change of the Lambertian lobe
    float gloss_share; // of light samples that follow the microfacets below the coat; less than 0: of none
};

// The fraction of the light from everywhere that a lobe reflects; of a coat about.
vec3 reflected_fraction(Gloss gloss) {
    return gloss.reflected * (gloss.f0 + gloss.mean_rise * (gloss.schlick + gloss.dielectric));
}

// The same of all microfacets.
vec3 reflected_fraction(Lobes lobes) {
    vec3 reflected = reflected_fraction(lobes.gloss);
#if COAT
    reflected += reflected_fraction(lobes.coat);
#endif
    return reflected;
}

Lobes lobes_at(ivec2 at, Surface surface, vec3 wo) {
    Lobes lobes;
    lobes.normal = surface.normal;
    lobes.wo = wo;
    uvec4 entries = fetch(ltc_entries, at);
    uvec4 rise = fetch(gloss_rise, at);
    lobes.gloss = unpack_gloss(fetch(gloss_reflectance, at), rise, entries.xy);
    lobes.facets = microfacets(lobes.gloss, surface.normal);
    lobes.exist = is_glossy(lobes.gloss);
    lobes.gloss_share = lobes.exist ? 1.0 : -1.0;
    lobes.base_color = surface.base_color;
    lobes.change_diffuse = false;
#if BUMPS
    lobes.smooth_normal = unpack_smooth_normal(rise, surface.normal);
    lobes.change_diffuse = lobes.smooth_normal != surface.normal;
#endif
#if RARE_LOBES
    lobes.rare = unpack_rare_lobes(fetch(rare_lobes, at));
    lobes.facets = anisotropic_microfacets(lobes.gloss, lobes.rare, surface.normal);
    lobes.change_diffuse = lobes.change_diffuse || lobes.rare.diffuse_roughness > 0.0;
    lobes.exist = lobes.exist || lobes.rare.sheen != vec3(0.0);
#endif
    lobes.exist = lobes.exist || lobes.change_diffuse;
#if COAT
    Coat above_all = unpack_coat(fetch(coat, at), entries.zw);
    lobes.coat = above_all.gloss;
    lobes.coat.mean_rise = dielectric_rise(max(dot(above_all.normal, wo), 0.0), lobes.coat.eta);
    lobes.coat_facets = microfacets(lobes.coat, above_all.normal);
    if (is_glossy(lobes.coat)) {
        vec3 below = reflected_fraction(lobes.gloss);
        vec3 above = reflected_fraction(lobes.coat);
        lobes.gloss_share = dot(below, vec3(1.0)) / (dot(below, vec3(1.0)) + dot(above, vec3(1.0)));
        lobes.exist = true;
    }
#endif
    return lobes;
}

// The fraction of light from wi that diffuse reflection and sheen do not lose to bumps.
float bump_shadowing(Lobes lobes, vec3 wi) {
#if BUMPS
    return bump_shadowing(lobes.normal, lobes.smooth_normal, wi);
#else
    return 1.0;
#endif
}

// What is diffusely reflected beyond Lambert's lobe, times the cosine, 1/sr.
vec3 evaluate_further_diffuse(Lobes lobes, vec3 wi) {
    vec3 lambert = lobes.base_color * (INVERSE_PI * max(dot(lobes.normal, wi), 0.0)), diffuse = lambert;
#if RARE_LOBES
    if (lobes.rare.diffuse_roughness > 0.0)
        diffuse += evaluate_rough_diffuse(lobes.base_color, lobes.rare, lobes.normal, lobes.wo, wi);
#endif
    return bump_shadowing(lobes, wi) * diffuse - lambert;
}

// The lobes times the cosine, and the density of `sample_lobes`, both 1/sr.
LobeValue evaluate_lobes(Lobes lobes, vec3 wi) {
    LobeValue value = evaluate_gloss(lobes.gloss, lobes.facets, lobes.wo, wi);
    value.pdf *= max(lobes.gloss_share, 0.0);
#if COAT
    LobeValue above = evaluate_gloss(lobes.coat, lobes.coat_facets, lobes.wo, wi);
    value.reflected += above.reflected;
    value.pdf += (1.0 - abs(lobes.gloss_share)) * above.pdf;
#endif
#if BUMPS
    if (dot(lobes.smooth_normal, wi) <= 0.0) value.reflected = vec3(0.0); // light from below the surface without bumps
#endif
#if RARE_LOBES
    if (lobes.rare.sheen != vec3(0.0))
        value.reflected += lobes.rare.sheen * (bump_shadowing(lobes, wi) *
            evaluate_sheen(lobes.rare.sheen_shape, lobes.normal, lobes.wo, wi));
#endif
    if (lobes.change_diffuse) value.reflected += evaluate_further_diffuse(lobes, wi);
    return value;
}

// A direction from which a visible microfacet reflects light to the camera.
vec3 sample_lobes(Lobes lobes, vec2 uv) {
#if COAT
    bool below = uv.x < lobes.gloss_share;
    uv.x = below ? uv.x / max(lobes.gloss_share, 1e-6) : (uv.x - lobes.gloss_share) / max(1.0 - lobes.gloss_share, 1e-6);
    if (!below) return reflect(-lobes.wo, sample_visible_normal(lobes.coat_facets, lobes.wo, uv));
#endif
    return reflect(-lobes.wo, sample_visible_normal(lobes.facets, lobes.wo, uv));
}
