// Operations of nodes that give what is known of a point: its surface and the camera. As in Cycles.
#include "nodes/point.glsl"
#include "nodes/vectors.glsl"

vec3 geometry_position(ShadingPoint at) { return at.position + anchor.xyz; }
vec3 geometry_normal(ShadingPoint at) { return at.normal; }
vec3 geometry_true_normal(ShadingPoint at) { return at.geometric_normal; }
vec3 geometry_incoming(ShadingPoint at) { return at.incoming; }
vec3 geometry_parametric(ShadingPoint at) { return vec3(at.barycentric.xy, 0.0); }
float geometry_backfacing(ShadingPoint at) { return float(at.is_back); }
vec3 coordinate_reflection(ShadingPoint at) { return -reflect(at.incoming, at.normal); }

// z is along the view.
vec3 coordinate_camera(ShadingPoint at) {
    vec3 p = (view_from_anchor * vec4(at.position, 1.0)).xyz;
    return vec3(p.xy, -p.z);
}

vec3 coordinate_window(ShadingPoint at) {
    vec4 p = clip_from_anchor * vec4(at.position, 1.0);
    return vec3(0.5 * p.xy / p.w + 0.5, 0.0);
}

// Reflectance of a dielectric with a ratio of refractive indices, at the cosine of the angle of incidence.
float fresnel_dielectric(float cosine, float eta) {
    float c = abs(cosine), square = eta * eta - 1.0 + c * c;
    if (square <= 0.0) return 1.0;
    float g = sqrt(square), a = (g - c) / (g + c), b = (c * (g + c) - 1.0) / (c * (g - c) + 1.0);
    return 0.5 * a * a * (1.0 + b * b);
}

float fresnel(ShadingPoint at, float ior, vec3 normal) {
    float eta = max(ior, 1e-5);
    return fresnel_dielectric(dot(at.incoming, normal), at.is_back ? 1.0 / eta : eta);
}

float layer_weight_fresnel(ShadingPoint at, float blend, vec3 normal) {
    float eta = max(1.0 - blend, 1e-5);
    return fresnel_dielectric(dot(at.incoming, normal), at.is_back ? eta : 1.0 / eta);
}

float layer_weight_facing(ShadingPoint at, float blend, vec3 normal) {
    float cosine = abs(dot(at.incoming, normal)), limited = clamp(blend, 0.0, 1.0 - 1e-5);
    float exponent = limited < 0.5 ? 2.0 * limited : 0.5 / (1.0 - limited);
    return 1.0 - math_power(cosine, exponent);
}

float ray_length(ShadingPoint at) { return length(coordinate_camera(at)); }
