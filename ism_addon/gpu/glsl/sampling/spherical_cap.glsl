// Samples of the part of a spherical cap of directions that is above the receiver's horizon. In the plane perpendicular
// to the cap's axis, x towards the normal, chords along x are chosen evenly over y, and points evenly along a chord; a
// cap that the horizon does not cut is sampled by solid angle. `sine`: of half of the cap's angle; 1: a hemisphere;
// more: all directions. `cosine`: of the angle from the receiver's normal to the axis.
#include "sampling/cosine_hemisphere.glsl"

struct CapSample { vec3 wi; float pdf; }; // 1/sr

// The horizon is where x = -cosine sqrt(1 - y^2). The half width in y of all chords.
float cap_half_width(float cosine, float sine) {
    return cosine >= 0.0 ? sine : sqrt(max((sine * sine - cosine * cosine) / max(1.0 - cosine * cosine, 1e-30), 0.0));
}

// The ends of the chord at y.
vec2 cap_chord(float cosine, float sine, float y) {
    float end = sqrt(max(sine * sine - y * y, 0.0));
    return vec2(max(-end, -cosine * sqrt(1.0 - y * y)), end);
}

// Caps wider than this that the horizon cuts are sampled as the receiver's hemisphere: towards their rim samples in the
// plane are too rare.
const float WIDE_CAP = 0.8;

bool samples_hemisphere(float cosine, float sine) { return sine >= 1.0 || (sine > WIDE_CAP && cosine < sine); }

// 1/sr, of a direction in the cap above the horizon. x and y: its coordinates in the plane.
float cap_plane_pdf(float cosine, float sine, vec2 at) {
    if (cosine >= sine) return 0.15915494309189535 * (1.0 + sqrt(1.0 - sine * sine)) / (sine * sine);
    vec2 chord = cap_chord(cosine, sine, at.y);
    float area = 2.0 * cap_half_width(cosine, sine) * max(chord.y - chord.x, 0.0);
    return sqrt(max(1.0 - dot(at, at), 0.0)) / max(area, 1e-37);
}

// Axes of the plane.
mat3 cap_basis(vec3 axis, vec3 n) {
    vec3 y = cross(axis, n);
    float size = dot(y, y);
    y = size > 1e-12 ? y * inversesqrt(size)
                     : normalize(cross(axis, abs(axis.x) < 0.5 ? vec3(1.0, 0.0, 0.0) : vec3(0.0, 1.0, 0.0)));
    return mat3(cross(y, axis), y, axis);
}

// Of a hemisphere's samples, some are outside of the cap.
CapSample cap_sample(vec3 axis, float sine, vec3 n, vec2 uv) {
    float cosine = dot(n, axis), angle = 6.283185307179586 * uv.y;
    if (samples_hemisphere(cosine, sine)) {
        vec3 wi = cap_basis(n, axis) * cosine_hemisphere(uv);
        return CapSample(wi, cosine_hemisphere_pdf(dot(n, wi)));
    }
    vec2 at;
    if (cosine >= sine) {
        float depth = uv.x * sine * sine / (1.0 + sqrt(1.0 - sine * sine)); // 1 - cosine to the axis
        at = sqrt(depth * (2.0 - depth)) * vec2(cos(angle), sin(angle));
    } else {
        at.y = (2.0 * uv.y - 1.0) * cap_half_width(cosine, sine);
        vec2 chord = cap_chord(cosine, sine, at.y);
        at.x = mix(chord.x, chord.y, uv.x);
    }
    vec3 wi = cap_basis(axis, n) * vec3(at, sqrt(max(1.0 - dot(at, at), 0.0)));
    return CapSample(wi, cap_plane_pdf(cosine, sine, at));
}

bool is_in_cap(vec3 axis, float sine, vec3 wi) {
    vec3 lateral = cross(axis, wi);
    return sine >= 1.0 ? true : dot(axis, wi) > 0.0 && dot(lateral, lateral) <= sine * sine;
}

// Of a direction above the horizon.
float cap_pdf(vec3 axis, float sine, vec3 n, vec3 wi) {
    float cosine = dot(n, axis);
    if (samples_hemisphere(cosine, sine)) return cosine_hemisphere_pdf(dot(n, wi));
    return is_in_cap(axis, sine, wi) ? cap_plane_pdf(cosine, sine, (wi * cap_basis(axis, n)).xy) : 0.0;
}
