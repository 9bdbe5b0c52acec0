// Lobes that few materials have: sheen, and what roughness changes of a diffuse lobe.
#include "maths/pi.glsl"

// Sheen is a linearly transformed cosine itself (Zeltner, Burley & Chiang 2022): of this transform to a cosine.
mat3 sheen_cosine_from_anchor(vec2 shape, vec3 n, vec3 wo) {
    return mat3(shape.x, 0.0, 0.0, 0.0, shape.x, 0.0, shape.y, 0.0, 1.0) * transpose(camera_frame(n, wo));
}

// Its value times the cosine, 1/sr.
float evaluate_sheen(vec2 shape, vec3 n, vec3 wo, vec3 wi) {
    vec3 transformed = sheen_cosine_from_anchor(shape, n, wo) * wi;
    float square = max(dot(transformed, transformed), 1e-30);
    return INVERSE_PI * max(transformed.z, 0.0) * shape.x * shape.x / (square * square);
}

// The reflected fraction of a rough surface's light from wi, without what is reflected several times (Fujii 2012).
float rough_diffuse_fraction(float cosine) {
    if (cosine < 1e-6) return 1.5707963267948966 - 2.0 / 3.0 - cosine;
    float sine = sqrt(max(1.0 - cosine * cosine, 0.0)), cubed = sine * sine * sine;
    return sine * (acos(min(cosine, 1.0)) - 2.0 / 3.0 - sine * cosine) + 2.0 / 3.0 * (sine / cosine) * (1.0 - cubed);
}

// The difference of a rough surface's value from Lambert's, times the cosine, 1/sr: Oren & Nayar 1994 as improved by Fujii
// 2012, with the light that is reflected several times, as in Cycles since 4.3, or without it.
vec3 evaluate_rough_diffuse(vec3 reflectance, RareLobes rare, vec3 n, vec3 wo, vec3 wi) {
    const float PI = 3.141592653589793;
    float to_light = max(dot(n, wi), 0.0), to_camera = max(dot(n, wo), 0.0);
    float roughness = rare.diffuse_roughness, a = 1.0 / (PI + roughness * (0.5 * PI - 2.0 / 3.0)), b = roughness * a;
    float t = dot(wi, wo) - to_light * to_camera;
    if (t > 0.0) t /= max(max(to_light, to_camera), 1e-6);
    float mean = a * PI + (2.0 * PI - 5.6) / 3.0 * b;
    float of_light = a * PI + b * rough_diffuse_fraction(to_light);
    float of_camera = a * PI + b * rough_diffuse_fraction(to_camera);
    vec3 limited = clamp(reflectance / max(rare.diffuse_weight, 1e-3), 0.0, 1.0) * sign(rare.diffuse_weight);
    vec3 further = limited * limited * (mean / max(1.0 - mean, 1e-6)) / (PI * (1.0 - limited * (1.0 - mean)));
    further *= (1.0 - of_camera) * (1.0 - of_light);
    return reflectance * to_light * (a + b * t - 1.0 / PI + further);
}
