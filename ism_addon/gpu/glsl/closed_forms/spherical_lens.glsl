// Irradiance of what two spherical caps of radiance 1 have in common, whatever the receiver's horizon: by Stokes' theorem
// the vector irradiance is the sum of both arcs' r x dr / 2, which is that of a circular segment of each cap's disc.
#include "maths/atan2.glsl"

// Area of the segment of the unit disc beyond x, whose half chord is y.
float disc_segment(float x, float y) {
    if (x > 0.0 && y < 0.1) return y * y * y * (2.0 / 3.0 + 0.2 * y * y);
    return atan2_accurate(y, x) - x * y;
}

// Of caps around a and b; `cosine`: of the angle between them. The caps' half angles by cosine and sine.
vec3 spherical_lens_irradiance(vec3 a, vec2 half_a, vec3 b, vec2 half_b, float cosine) {
    float sine = max(sqrt(max(1.0 - cosine * cosine, 0.0)), 1e-6);
    float x_a = clamp((half_b.x - half_a.x * cosine) / (half_a.y * sine), -1.0, 1.0);
    float x_b = clamp((half_a.x - half_b.x * cosine) / (half_b.y * sine), -1.0, 1.0);
    float y = sqrt(1.0 - x_a * x_a), y_b = min(half_a.y * y / half_b.y, 1.0); // both arcs have the same chord
    return half_a.y * half_a.y * disc_segment(x_a, y) * a + half_b.y * half_b.y * disc_segment(x_b, y_b) * b;
}
