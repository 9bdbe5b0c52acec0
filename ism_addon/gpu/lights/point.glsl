// Points: spheres of uniform radiance, or disks of the same radius that face the receiver. A receiver sees either as a
// spherical cap around the direction to the position, so their irradiance is that of a cap. All are of intensity 1 W/sr.
// A shader variant for lights with or without a radius sets one of these to 0, as some drivers execute both branches.
#ifndef POINTS_WITH_RADIUS
#define POINTS_WITH_RADIUS 1
#endif
#ifndef POINTS_WITHOUT_RADIUS
#define POINTS_WITHOUT_RADIUS 1
#endif
#include "closed_forms/spherical_cap.glsl"

bool point_has_radius(Light light) {
    return POINTS_WITHOUT_RADIUS == 0 || (POINTS_WITH_RADIUS == 1 && light.radius > 0.0);
}

// What a receiver sees of a light: the square of the distance by which its intensity is divided, and the sine of half of
// the cap's angle, more than 1 inside a sphere.
struct PointCap { vec3 axis; float distance; float inverse_square; float sine; };

PointCap point_cap(Light light, vec3 p) {
    vec3 to = light.position - p;
    float square = dot(to, to), radius_square = light.radius * light.radius;
    float falloff = max(light.soft_falloff != 0 ? square + radius_square : square, 1e-30);
    float distance = sqrt(max(square, 1e-30));
    return PointCap(to / distance, distance, 1.0 / falloff, light.radius * inversesqrt(falloff));
}

float point_radiance(Light light) { return 0.3183098861837907 / (light.radius * light.radius); }

float point_irradiance(Light light, vec3 p, vec3 n) {
    PointCap cap = point_cap(light, p);
    float cosine = dot(n, cap.axis);
    if (!point_has_radius(light) || cosine >= cap.sine) return max(cosine, 0.0) * cap.inverse_square;
    if (cap.sine >= 1.0) return 1.0 / (light.radius * light.radius); // inside
    return spherical_cap_irradiance(cosine, cap.sine) * point_radiance(light);
}

// The part of a cap above the receiver's horizon, in the plane perpendicular to the cap's axis: x towards the normal.
// The horizon is where x = -cosine sqrt(1 - y^2).

// The half width in y of all chords.
float point_half_width(float cosine, float sine) {
    return cosine >= 0.0 ? sine : sqrt(max((sine * sine - cosine * cosine) / max(1.0 - cosine * cosine, 1e-30), 0.0));
}

// The ends of the chord at y.
vec2 point_chord(float cosine, float sine, float y) {
    float end = sqrt(max(sine * sine - y * y, 0.0));
    return vec2(max(-end, -cosine * sqrt(1.0 - y * y)), end);
}

// Caps wider than this that the horizon cuts are sampled as the hemisphere: towards their rim samples in the plane are
// too rare.
const float WIDE_CAP = 0.8;

bool point_samples_hemisphere(float cosine, float sine) { return sine >= 1.0 || (sine > WIDE_CAP && cosine < sine); }

// 1/sr, of a direction in the cap above the horizon. x and y: its coordinates in the plane.
float point_direction_pdf(float cosine, float sine, vec2 at) {
    if (cosine >= sine) return 0.15915494309189535 * (1.0 + sqrt(1.0 - sine * sine)) / (sine * sine);
    vec2 chord = point_chord(cosine, sine, at.y);
    float area = 2.0 * point_half_width(cosine, sine) * max(chord.y - chord.x, 0.0);
    return sqrt(max(1.0 - dot(at, at), 0.0)) / max(area, 1e-37);
}

// Axes of the plane: x towards the normal.
mat3 point_basis(vec3 axis, vec3 n) {
    vec3 y = cross(axis, n);
    float size = dot(y, y);
    y = size > 1e-12 ? y * inversesqrt(size)
                     : normalize(cross(axis, abs(axis.x) < 0.5 ? vec3(1.0, 0.0, 0.0) : vec3(0.0, 1.0, 0.0)));
    return mat3(cross(y, axis), y, axis);
}

// The distance to a sphere's surface, or to a disk, along a direction that meets it.
float point_distance(Light light, PointCap cap, float cosine) {
    float d = cap.distance;
    if (light.soft_falloff != 0) return d / max(cosine, 1e-6);
    float root = sqrt(max(light.radius * light.radius - d * d * (1.0 - cosine * cosine), 0.0));
    return d * cosine + (cap.sine < 1.0 ? -root : root);
}

LightSample point_sample(Light light, vec3 p, vec3 n, vec2 uv) {
    PointCap cap = point_cap(light, p);
    if (!point_has_radius(light)) return LightSample(light.position, cap.axis, cap.inverse_square, 1.0);
    float cosine = dot(n, cap.axis), angle = 6.283185307179586 * uv.y, pdf, sine = min(cap.sine, 1.0);
    vec3 wi;
    if (point_samples_hemisphere(cosine, cap.sine)) {
        wi = point_basis(n, cap.axis) * vec3(sqrt(uv.x) * vec2(cos(angle), sin(angle)), sqrt(1.0 - uv.x));
        pdf = 0.3183098861837907 * dot(n, wi);
    } else {
        vec2 at;
        if (cosine >= sine) {
            float depth = uv.x * sine * sine / (1.0 + sqrt(1.0 - sine * sine)); // 1 - cosine to the axis
            at = sqrt(depth * (2.0 - depth)) * vec2(cos(angle), sin(angle));
        } else {
            at.y = (2.0 * uv.y - 1.0) * point_half_width(cosine, sine);
            vec2 chord = point_chord(cosine, sine, at.y);
            at.x = mix(chord.x, chord.y, uv.x);
        }
        wi = point_basis(cap.axis, n) * vec3(at, sqrt(max(1.0 - dot(at, at), 0.0)));
        pdf = point_direction_pdf(cosine, sine, at);
    }
    float to_axis = dot(wi, cap.axis);
    bool hits = cap.sine >= 1.0 || to_axis * to_axis >= (1.0 - sine * sine) * (1.0 - 1e-6);
    float radiance = hits && (cap.sine >= 1.0 || to_axis > 0.0) && pdf > 0.0 ? point_radiance(light) : 0.0;
    return LightSample(p + point_distance(light, cap, to_axis) * wi, wi, radiance, max(pdf, 1e-37));
}

float point_emitted(Light light, vec3 p, vec3 wi) {
    if (!point_has_radius(light)) return 0.0;
    PointCap cap = point_cap(light, p);
    if (cap.sine >= 1.0) return point_radiance(light);
    vec3 lateral = cross(cap.axis, wi);
    return dot(cap.axis, wi) > 0.0 && dot(lateral, lateral) <= cap.sine * cap.sine ? point_radiance(light) : 0.0;
}

float point_pdf(Light light, vec3 p, vec3 n, vec3 wi) {
    if (!point_has_radius(light) || dot(n, wi) <= 0.0) return 0.0;
    PointCap cap = point_cap(light, p);
    float cosine = dot(n, cap.axis);
    if (point_samples_hemisphere(cosine, cap.sine)) return 0.3183098861837907 * dot(n, wi);
    if (point_emitted(light, p, wi) == 0.0) return 0.0;
    return point_direction_pdf(cosine, cap.sine, (wi * point_basis(cap.axis, n)).xy);
}

// Virtual lights lie on the sphere, and face outwards.
float point_virtual_weight(Light light, vec3 v, vec3 n, vec3 axis) {
    float square = max(dot(v, v), 1e-30), height = dot(axis, v);
    float weight = max(-dot(n, v), 0.0) / (square * sqrt(square));
    return weight * (point_has_radius(light) ? max(height, 0.0) * inversesqrt(square) : (height > 0.0 ? 1.0 : 0.0));
}
