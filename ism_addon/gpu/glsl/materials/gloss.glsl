// Lobes of microfacets: their value, samples of visible normals, and their transforms to a cosine.
#include "maths/orthonormal_basis.glsl"
#include "maths/pi.glsl"
#include "materials/ltc.glsl"
#include "materials/gloss_packing.glsl"

// Below this roughness, differences between directions would be rounded away.
const float MIN_ROUGHNESS = 0.01;

// Below this roughness, surfaces are mirrors, in which lights without a size are not seen. As in Cycles 4.5 and 5.0.
const float MIRROR_ROUGHNESS = 0.00376;

// The lobe for lights without a size.
Gloss gloss_for_points(Gloss gloss) {
    if (gloss.roughness < MIRROR_ROUGHNESS) gloss.f0 = gloss.schlick = gloss.dielectric = gloss.edge = vec3(0.0);
    return gloss;
}

// Microfacets' roughness along the axes of a frame whose z is the surface's normal.
struct Microfacets { mat3 frame; vec2 alpha; bool beckmann; };

Microfacets microfacets(Gloss gloss, vec3 n) {
    return Microfacets(basis(n), vec2(pow(max(gloss.roughness, MIN_ROUGHNESS), 2.0)), false);
}

#if RARE_LOBES
Microfacets anisotropic_microfacets(Gloss gloss, RareLobes rare, vec3 n) {
    Microfacets facets = microfacets(gloss, n);
    float angle = 6.283185307179586 * rare.tangent_angle;
    vec3 tangent = cos(angle) * facets.frame[0] + sin(angle) * facets.frame[1];
    facets.frame = mat3(tangent, cross(n, tangent), n);
    facets.beckmann = rare.beckmann;
    facets.alpha = min(facets.alpha * vec2(1.0 / rare.aspect, rare.aspect), 1.0);
    return facets;
}
#endif

// The reflectance of microfacets at this cosine to their normals.
vec3 reflectance(Gloss gloss, float cosine) {
    return max(gloss.f0 + gloss.schlick * schlick_rise(cosine) + gloss.dielectric * dielectric_rise(cosine, gloss.eta) -
                   gloss.edge * edge_change(cosine), 0.0);
}

// Density of microfacets' normals (Trowbridge & Reitz 1975); h in their frame.
float ggx_density(vec3 h, vec2 alpha) {
    vec2 across = h.xy / alpha;
    float t = dot(across, across) + h.z * h.z;
    return INVERSE_PI / max(alpha.x * alpha.y * t * t, 1e-30);
}

// Smith's function of hidden microfacets.
float ggx_lambda(vec3 wi, vec2 alpha) {
    vec2 across = alpha * wi.xy;
    return 0.5 * (sqrt(1.0 + dot(across, across) / max(wi.z * wi.z, 1e-12)) - 1.0);
}

// The same of the distribution of Beckmann & Spizzichino 1963, as in Walter et al. 2007.
float beckmann_density(vec3 h, vec2 alpha) {
    float square = max(h.z * h.z, 1e-12);
    vec2 slope = h.xy / alpha;
    return INVERSE_PI * exp(-dot(slope, slope) / square) / (alpha.x * alpha.y * square * square);
}

float beckmann_lambda(vec3 wi, vec2 alpha) {
    vec2 across = alpha * wi.xy;
    float a = abs(wi.z) * inversesqrt(max(dot(across, across), 1e-30));
    return a < 1.6 ? (1.0 + a * (0.396 * a - 1.259)) / max(a * (3.535 + 2.181 * a), 1e-6) : 0.0;
}

struct LobeValue { vec3 reflected; float pdf; };

// The lobe times the cosine, and the density of reflections by `sample_visible_normal`, both 1/sr.
LobeValue evaluate_gloss(Gloss gloss, Microfacets facets, vec3 wo, vec3 wi) {
    vec3 sum = wi + wo, h = sum * inversesqrt(max(dot(sum, sum), 1e-30));
    vec3 to_light = wi * facets.frame, to_camera = wo * facets.frame;
    if (to_light.z <= 0.0) return LobeValue(vec3(0.0), 0.0);
    to_camera.z = max(to_camera.z, 1e-6);
    float density = ggx_density(h * facets.frame, facets.alpha) / (4.0 * to_camera.z);
    float hidden = ggx_lambda(to_camera, facets.alpha);
    vec3 reflected = reflectance(gloss, dot(h, wi));
    if (facets.beckmann) {
        float visible = 1.0 + beckmann_lambda(to_camera, facets.alpha) + beckmann_lambda(to_light, facets.alpha);
        reflected *= beckmann_density(h * facets.frame, facets.alpha) / (4.0 * to_camera.z * visible);
    } else {
        reflected *= density / (1.0 + hidden + ggx_lambda(to_light, facets.alpha));
    }
    return LobeValue(reflected, density / (1.0 + hidden));
}

// The normal of a microfacet that is visible from wo (Dupuy & Benyoub 2023).
vec3 sample_visible_normal(Microfacets facets, vec3 wo, vec2 uv) {
    vec3 from = wo * facets.frame, stretched = normalize(vec3(facets.alpha * from.xy, from.z));
    float angle = 6.283185307179586 * uv.x, z = (1.0 - uv.y) * (1.0 + stretched.z) - stretched.z;
    float sine = sqrt(clamp(1.0 - z * z, 0.0, 1.0));
    vec3 h = vec3(sine * cos(angle), sine * sin(angle), z) + stretched;
    return facets.frame * normalize(vec3(facets.alpha * h.xy, max(h.z, 1e-7)));
}

// A frame whose z is the normal and whose x is the direction to the camera along the surface.
mat3 camera_frame(vec3 n, vec3 wo) {
    vec3 along = wo - dot(wo, n) * n;
    float size = dot(along, along);
    if (size <= 1e-8) return basis(n);
    vec3 x = along * inversesqrt(size);
    return mat3(x, cross(n, x), n);
}

// From anchor space to that in which the lobe is a cosine about z (Heitz, Dupuy, Hill & Neubelt 2016).
mat3 cosine_from_anchor(Gloss gloss, vec3 n, vec3 wo) {
    vec4 m = ltc_inverse_of(gloss.ltc, max(gloss.roughness, MIN_ROUGHNESS), dot(n, wo));
    return mat3(m.x, 0.0, m.z, 0.0, 1.0, 0.0, m.y, 0.0, m.w) * transpose(camera_frame(n, wo));
}

#if RARE_LOBES
// From the lobe of anisotropic microfacets to that of isotropic ones of their mean roughness. The slopes of anisotropic
// ones are stretched along the axes of their frame. The lobe is stretched about the mirror direction: on smooth surfaces
// along the derivatives of the mirror direction by the slopes; on rough ones along the axes' projections perpendicular to
// it, and less. The numbers were chosen by the error on spheres under a rectangle and a sun.
mat3 isotropic_from_anisotropic(Gloss gloss, Microfacets facets, float aspect, vec3 wo) {
    const float MIN_COSINE = 0.1; // at grazing angles the axes would be nearly parallel
    float alpha = gloss.roughness * gloss.roughness, stretch = pow(aspect, 1.0 - 0.75 * alpha);
    vec3 n = facets.frame[2];
    wo = normalize(wo + max(MIN_COSINE - dot(n, wo), 0.0) * n);
    vec3 mirror = reflect(-wo, n);
    mat2x3 axes;
    for (int k = 0; k < 2; ++k) {
        vec3 axis = facets.frame[k];
        vec3 derivative = dot(n, wo) * axis + dot(axis, wo) * n, projection = axis + dot(axis, wo) * mirror;
        axes[k] = mix(derivative, projection, min(10.0 * alpha, 1.0));
    }
    return mat3(stretch * axes[0], axes[1] / stretch, mirror) * inverse(mat3(axes[0], axes[1], mirror));
}
#endif
