// Glossy shaders, as in Cycles: lobes of microfacets (GGX), whose reflectance is a sum of functions of the angle.
#include "nodes/closures.glsl"
#include "maths/orthonormal_basis.glsl"
#include "materials/gloss_packing.glsl"
#include "materials/lobe_tables.glsl"

// The cosine of the camera's direction, whose lobe's tables are read.
float view_cosine(ShadingPoint at, vec3 normal) { return clamp(dot(at.incoming, normal), 0.0, 1.0); }

// Factor on the single reflections of a lobe: light that is reflected several times between microfacets is not lost. A
// color, as each reflection absorbs some (Kulla & Conty 2017; Turquin 2019). `mean`: cosine-weighted, of the reflectance.
vec3 multiple_reflections(vec3 mean, float albedo, float mean_albedo) {
    vec3 further = mean * mean_albedo / max(1.0 - mean * (1.0 - mean_albedo), 1e-6);
    return 1.0 + further * (1.0 - albedo) / albedo;
}

vec3 multiple_ggx_reflections(vec3 mean, float roughness, float cosine) {
    return multiple_reflections(mean, ggx_albedo(roughness, cosine), ggx_mean_albedo(roughness));
}

// Returns its weight among all lobes: 0 if that is no number, and the lobe is left out.
float add_lobe(inout GlossyClosures glossy, vec3 f0, vec3 schlick, vec3 dielectric, vec3 edge, float roughness, float eta) {
    float rise = sum_of(dielectric), weight = sum_of(f0) + 0.05 * (sum_of(schlick) + rise);
    if (!(weight + roughness <= MAX_COLOR)) return 0.0;
    glossy.f0 += f0;
    glossy.schlick += schlick;
    glossy.dielectric += dielectric;
    glossy.edge += edge;
    glossy.roughness += weight * roughness;
    glossy.roughness_weight += weight;
    glossy.eta += rise * eta;
    glossy.eta_weight += rise;
    return weight;
}

// A lobe of the same reflectance at all angles.
void closure_glossy(inout Closures closures, ShadingPoint at, vec3 weight, vec3 color, float roughness, vec3 normal,
                    int multiple) {
    vec3 f0 = max(color, 0.0), scale = max(weight, 0.0);
    roughness = clamp(roughness, 0.0, 1.0);
    if (multiple == 1) scale *= multiple_ggx_reflections(min(f0, 1.0), roughness, view_cosine(at, normal));
    vec3 none = vec3(0.0);
    closures.normal += normal * add_lobe(closures.glossy, scale * f0, none, none, none, roughness, 1.0);
}

void closure_metal(inout Closures closures, ShadingPoint at, vec3 weight, vec3 color, vec3 edge_tint, float roughness,
                   vec3 normal, int multiple) {
    vec3 f0 = clamp(color, 0.0, 1.0), tint = clamp(edge_tint, 0.0, 1.0), scale = max(weight, 0.0);
    roughness = clamp(roughness, 0.0, 1.0);
    // At this cosine, the reflectance is the tint's fraction of Schlick's.
    float there = 1.0 / 7.0;
    vec3 edge = mix(f0, vec3(1.0), schlick_rise(there)) / edge_change(there) * (1.0 - tint);
    vec3 mean = mix(f0, vec3(1.0), 1.0 / 21.0) - edge / 126.0;
    if (multiple == 1) scale *= multiple_ggx_reflections(mean, roughness, view_cosine(at, normal));
    vec3 schlick = scale * (1.0 - f0);
    closures.normal +=
        normal * add_lobe(closures.glossy, scale * f0, schlick, vec3(0.0), scale * edge, roughness, 1.0);
}

// What glass reflects. Light that it transmits is lost, but not what that adds between microfacets.
void closure_glass(inout Closures closures, ShadingPoint at, vec3 weight, vec3 color, float ior, float roughness,
                   vec3 normal, int multiple) {
    float eta = max(ior, 1e-5), f0 = dielectric_f0(eta), cosine = view_cosine(at, normal);
    vec3 scale = max(weight * color, 0.0), none = vec3(0.0);
    roughness = clamp(roughness, 0.0, 1.0);
    if (multiple == 1 && eta > 1.0) {
        vec2 albedo = vec2(glass_albedo(roughness, cosine, eta), glass_mean_albedo(roughness, eta));
        scale *= multiple_reflections(clamp(color, 0.0, 1.0), albedo.x, albedo.y);
    }
    closures.normal += normal * add_lobe(closures.glossy, scale * f0, none, scale * (1.0 - f0), none, roughness, eta);
}

struct Dielectric { vec3 f0; float eta; };

// The reflectance at normal incidence, which the level scales and the tint colors, and the index of refraction.
Dielectric dielectric_of(ShadingPoint at, float ior, float level, vec3 tint) {
    float eta = max(ior, 1e-5), f0 = dielectric_f0(eta);
    if (level != 0.5) {
        f0 = clamp(f0 * 2.0 * level, 0.0, 0.99);
        float root = sqrt(f0);
        eta = ior < 1.0 ? (1.0 - root) / (1.0 + root) : (1.0 + root) / (1.0 - root);
    }
    return Dielectric(clamp(f0 * tint, 0.0, 1.0), eta);
}

// The cosine-weighted mean of dielectric_rise (Kulla & Conty 2017).
float mean_dielectric_rise(float eta) {
    float f0 = dielectric_f0(eta), mean = (eta - 1.0) / (4.08567 + 1.00071 * eta);
    if (eta < 1.0) mean = 0.997118 + eta * (0.1014 - eta * (0.965241 + 0.130607 * eta));
    return clamp((mean - f0) / max(1.0 - f0, 1e-6), 0.0, 1.0);
}

void closure_dielectric(inout Closures closures, ShadingPoint at, vec3 weight, float ior, float level, vec3 tint,
                        float roughness, vec3 normal, int multiple) {
    Dielectric dielectric = dielectric_of(at, ior, level, tint);
    vec3 scale = dielectric.eta == 1.0 ? vec3(0.0) : max(weight, 0.0);
    roughness = clamp(roughness, 0.0, 1.0);
    vec3 mean = mix(dielectric.f0, vec3(1.0), mean_dielectric_rise(dielectric.eta));
    if (multiple == 1) scale *= multiple_ggx_reflections(mean, roughness, view_cosine(at, normal));
    vec3 f0 = scale * dielectric.f0, none = vec3(0.0);
    closures.normal +=
        normal * add_lobe(closures.glossy, f0, none, scale - f0, none, roughness, dielectric.eta);
}

// The weight of what lies below a dielectric's lobe: what that does not reflect, of the color that it reflects most of.
vec3 below_dielectric(ShadingPoint at, vec3 weight, float ior, float level, vec3 tint, float roughness, vec3 normal,
                      int multiple) {
    Dielectric dielectric = dielectric_of(at, ior, level, tint);
    if (dielectric.eta == 1.0) return weight;
    roughness = clamp(roughness, 0.0, 1.0);
    float cosine = view_cosine(at, normal);
    vec3 albedo = mix(dielectric.f0, vec3(1.0), dielectric_s(roughness, cosine, dielectric.eta));
    // Cycles counts what microfacets hide as reflected if light is reflected between them only once.
    if (multiple == 1) {
        vec3 mean = mix(dielectric.f0, vec3(1.0), mean_dielectric_rise(dielectric.eta));
        albedo *= ggx_albedo(roughness, cosine) * multiple_ggx_reflections(mean, roughness, cosine);
    }
    return weight * (1.0 - min(max(albedo.r, max(albedo.g, albedo.b)), 1.0));
}

// Makes the glossy lobes anisotropic, see materials/gloss.glsl: along the tangent, after a rotation about the normal, in
// turns.
void closure_anisotropy(inout Closures closures, ShadingPoint at, float aspect, float rotation, vec3 tangent,
                        vec3 normal) {
    float angle = 6.283185307179586 * rotation;
    vec3 across = cross(normal, tangent), along = tangent - dot(tangent, normal) * normal;
    vec3 rotated = cos(angle) * along + sin(angle) * across;
    closures.aspect = min(aspect, 1.0 / aspect);
    closures.tangent = aspect > 1.0 ? cross(normal, rotated) : rotated;
}

// Distributes microfacets of all glossy lobes but the coat as by Beckmann.
void closure_beckmann(inout Closures closures, ShadingPoint at, vec3 normal) { closures.beckmann = true; }

// A lobe above all others, of a dielectric.
void closure_coat(inout Closures closures, ShadingPoint at, vec3 weight, float ior, float roughness, vec3 normal,
                  int multiple) {
    vec3 scale = max(weight, 0.0), none = vec3(0.0);
    float eta = max(ior, 1.0), f0 = dielectric_f0(eta);
    if (multiple == 1) {
        vec3 mean = vec3(mix(f0, 1.0, mean_dielectric_rise(eta)));
        scale *= multiple_ggx_reflections(mean, clamp(roughness, 0.0, 1.0), view_cosine(at, normal));
    }
    float added = add_lobe(closures.coat, scale * f0, none, scale * (1.0 - f0), none, clamp(roughness, 0.0, 1.0), eta);
    closures.coat_normal += added * normal;
}

// The weight of what lies below a coat: what that does not reflect. A tint absorbs more along oblique paths.
vec3 below_coat(ShadingPoint at, vec3 weight, float amount, float ior, float roughness, vec3 tint, vec3 normal,
                int multiple) {
    float eta = max(ior, 1.0), cosine = view_cosine(at, normal);
    float refracted = sqrt(1.0 - (1.0 - cosine * cosine) / (eta * eta));
    vec3 passed = pow(max(tint, 0.0), vec3(1.0 / refracted));
    amount = clamp(amount, 0.0, 1.0);
    float reflected = fresnel_dielectric(cosine, eta);
    if (multiple == 1) {
        roughness = clamp(roughness, 0.0, 1.0);
        vec3 mean = vec3(mix(dielectric_f0(eta), 1.0, mean_dielectric_rise(eta)));
        reflected = mix(dielectric_f0(eta), 1.0, dielectric_s(roughness, cosine, eta));
        reflected *= ggx_albedo(roughness, cosine) * multiple_ggx_reflections(mean, roughness, cosine).r;
    }
    return weight * (1.0 - amount * reflected) * mix(vec3(1.0), passed, amount);
}

void closure_sheen(inout Closures closures, ShadingPoint at, vec3 weight, float roughness, vec3 normal) {
    vec3 shape = sheen_ltc(clamp(roughness, 1e-3, 1.0), view_cosine(at, normal));
    closures.sheen += max(weight, 0.0) * shape.z;
    closures.sheen_shape = shape.xy;
    closures.normal += sum_of(max(weight, 0.0)) * shape.z * normal;
}

// The weight of what lies below sheen, whose weight is a color.
vec3 below_sheen(ShadingPoint at, vec3 weight, vec3 amount, float roughness, vec3 normal) {
    float reflected = sheen_ltc(clamp(roughness, 1e-3, 1.0), view_cosine(at, normal)).z;
    return weight * (1.0 - clamp(reflected * max(amount.r, max(amount.g, amount.b)), 0.0, 1.0));
}

// One lobe in place of all, of their mean roughness. `cosine`: of the camera's direction. As in Cycles, microfacets on a
// normal that faces away from the camera reflect nothing to it.
Gloss gloss_of(GlossyClosures glossy, float cosine) {
    if (cosine <= 0.0) glossy.f0 = glossy.schlick = glossy.dielectric = glossy.edge = vec3(0.0);
    cosine = clamp(cosine, 0.0, 1.0);
    float roughness = glossy.roughness / max(glossy.roughness_weight, 1e-30);
    float eta = glossy.eta_weight > 0.0 ? glossy.eta / glossy.eta_weight : 1.0;
    vec2 rises = vec2(schlick_s(roughness, cosine), dielectric_s(roughness, cosine, eta));
    vec2 weights = vec2(sum_of(glossy.schlick), sum_of(glossy.dielectric));
    return Gloss(glossy.f0, glossy.schlick, glossy.dielectric, glossy.edge, eta, roughness,
                 ggx_albedo(roughness, cosine), dot(rises, weights) / max(weights.x + weights.y, 1e-30),
                 ltc_entry(roughness, cosine));
}

RareLobes rare_lobes_of(Closures closures, vec3 n) {
    vec3 across = cross(n, closures.tangent);
    mat3 frame = basis(n);
    float angle = atan(dot(closures.tangent, frame[1]), dot(closures.tangent, frame[0])) / 6.283185307179586;
    bool has_tangent = closures.aspect < 1.0 && dot(across, across) > 1e-12;
    vec2 diffuse = vec2(closures.diffuse_roughness, closures.diffuse_weight) / max(sum_of(closures.diffuse), 1e-30);
    return RareLobes(closures.sheen, closures.sheen_shape, has_tangent ? closures.aspect : 1.0,
                     has_tangent ? fract(angle) : 0.0, diffuse.x, diffuse.y, closures.beckmann);
}
