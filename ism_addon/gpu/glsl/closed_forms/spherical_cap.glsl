// Irradiance of a spherical cap of radiance 1, partly below the receiver's horizon (Snyder 1996). `cosine`: of the angle
// from the receiver's normal to the cap's centre; `sine`: of half of the cap's angle.
#include "maths/atan2.glsl"

float spherical_cap_irradiance(float cosine, float sine) {
    float square = sine * sine, depth = square - cosine * cosine; // below 0: the horizon does not cut the cap
    if (depth <= 0.0) return 3.141592653589793 * square * max(cosine, 0.0);
    float half_chord = sqrt(depth), rim = sqrt(max(1.0 - square, 0.0)), tangent = half_chord / rim;
    float above = square * cosine * atan2_accurate(half_chord, -cosine * rim);
    // atan(t) - t (1 - square), without the cancellation in small caps, by the series of atan(t) - t.
    float t = tangent * tangent;
    if (t < 0.02) return above + tangent * (square + t * (t * (t * (-1.0 / 7.0) + 0.2) - 1.0 / 3.0));
    return above + atan2_accurate(half_chord, rim) - half_chord * rim;
}
