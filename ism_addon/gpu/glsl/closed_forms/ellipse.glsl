// Irradiance by an ellipse of radiance 1 in closed form: the principal axes of its cone, see radiometry.py.
#include "maths/atan2.glsl"

// The only positive root of x^3 + p x^2 + q x - r, none of them complex, by Laguerre's method from x above it; without
// x^3 there is a bound that is close where the light is.
float positive_root(float x, float p, float q, float r) {
    float root = sqrt(max(q * q + 4.0 * p * r, 0.0));
    if (p > 0.0) x = min(x, q > 0.0 ? 2.0 * r / (root + q) : (root - q) / (2.0 * p));
    for (int k = 0; k < 3; ++k) {
        float f = ((x + p) * x + q) * x - r, slope = (3.0 * x + 2.0 * p) * x + q;
        x -= 3.0 * f / (slope + sqrt(max(4.0 * slope * slope - 12.0 * f * (3.0 * x + p), 0.0)));
    }
    return x;
}

// (atan(k x.y) - atan(k x.x)) / k.
float atan_step(float k, vec2 x) {
    float step = x.y - x.x;
    return k > 1e-4 ? sign(step) * atan2_accurate(k * abs(step), 1.0 + k * k * x.x * x.y) / k : step;
}

// (atanh(k x.y) - atanh(k x.x)) / k for given roots = sqrt(1 - k^2 x^2).
float atanh_step(float k, vec2 x, vec2 roots) {
    float step = (x.y - x.x) / (1.0 - k * k * x.x * x.y), s = k * k * step * step;
    if (s < 0.06) return step * ((((s / 9.0 + 1.0 / 7.0) * s + 1.0 / 5.0) * s + 1.0 / 3.0) * s + 1.0);
    vec2 size = (1.0 + k * abs(x)) / roots;
    return log((x.y < 0.0 ? 1.0 / size.y : size.y) * (x.x < 0.0 ? size.x : 1.0 / size.x)) / k;
}

// Lambert's integral along the rim of the cone (wide cos t, narrow sin t, 1), from one of its points to another.
float rim_integral(vec3 n, float wide, float narrow, vec3 from, vec3 to) {
    float a = 1.0 + wide * wide, b = 1.0 + narrow * narrow, k = sqrt(max(a - b, 0.0));
    vec2 scale = vec2(inversesqrt(a), inversesqrt(b));
    vec2 cosines = vec2(from.x / from.z, to.x / to.z) / wide, sines = vec2(from.y / from.z, to.y / to.z) / narrow;
    vec2 p = vec2(cosines.x, sines.x) / scale, q = vec2(cosines.y, sines.y) / scale;
    float turn = atan2_accurate(abs(p.x * q.y - p.y * q.x), dot(p, q));
    if (p.x * q.y < p.y * q.x) turn = 6.283185307179586 - turn;
    vec2 roots = vec2(length(from) / from.z, length(to) / to.z) * scale.x;
    return n.z * wide * narrow * turn * scale.x * scale.y
         - n.x * narrow * scale.x * atanh_step(k, sines * scale.x, roots)
         + n.y * wide * scale.y * atan_step(k, cosines * scale.y);
}

// The same for an ellipse seen as small, without cross(u, v): chords along the horizon, two points on each.
float small_clipped_ellipse(vec3 centre, vec3 u, vec3 v, vec2 turn, float level, float reach, int points) {
    const vec3 PLACES = vec3(0.2386191861, 0.6612093865, 0.9324695142);
    const vec3 SHARES = vec3(0.4679139346, 0.3607615730, 0.1713244924);
    vec3 up = u * turn.x + v * turn.y, across = (v * turn.x - u * turn.y) * 0.5773502692;
    float angle = atan2_accurate(sqrt(1.0 - level * level), -level), sum = 0.0;
    for (int k = 0; k < points; ++k) { // Gauss's points of the angle at which a chord ends
        float t = 0.5 * angle * (1.0 + (k % 2 == 0 ? PLACES[k / 2] : -PLACES[k / 2])), sine = sin(t);
        vec3 middle = centre + cos(t) * up, one = middle - sine * across, other = middle + sine * across;
        float a = 1.0 / dot(one, one), b = 1.0 / dot(other, other);
        sum += SHARES[k / 2] * (level + cos(t)) * sine * sine * (a * a + b * b);
    }
    return 0.5 * angle * reach * sum;
}

// The part above the receiver's horizon. `turn`: its normal's heights along u and v; `level`: of the centre, -1 to 1.
float clipped_ellipse(vec3 centre, vec3 u, vec3 v, vec3 n, vec2 turn, float level, mat3 frame, vec2 half_lengths) {
    float across = sqrt(1.0 - level * level);
    vec2 x = -level * turn, y = across * vec2(-turn.y, turn.x);
    vec3 from = centre + u * (x.x - y.x) + v * (x.y - y.y), to = centre + u * (x.x + y.x) + v * (x.y + y.y);
    float chord = atan2_accurate(length(cross(from, to)), dot(from, to));
    return 0.5 * max(chord + rim_integral(n * frame, half_lengths.x, half_lengths.y, from * frame, to * frame), 0.0);
}

// The cone's wide, narrow and given axis: the eigenvectors of what S is across the latter, with the larger eigenvalue.
mat3 principal_axes(vec3 axis, vec3 centre, vec3 u, vec3 v, out float most) {
    vec3 x = normalize(abs(axis.x) < 0.5 ? vec3(0.0, axis.z, -axis.y) : vec3(-axis.z, 0.0, axis.x)), y = cross(axis, x);
    vec3 on_x = vec3(dot(u, x), dot(v, x), dot(centre, x)), on_y = vec3(dot(u, y), dot(v, y), dot(centre, y));
    vec3 signs = vec3(1.0, 1.0, -1.0);
    float xx = dot(on_x * signs, on_x), xy = dot(on_x * signs, on_y), yy = dot(on_y * signs, on_y);
    vec2 twice = vec2(xx - yy, 2.0 * xy);
    float gap = length(twice);
    most = 0.5 * (xx + yy + gap);
    vec2 turn = gap > 0.0 ? twice / gap : vec2(1.0, 0.0); // by twice the angle
    float way = turn.y < 0.0 ? -1.0 : 1.0;
    turn = normalize(turn.x > 0.0 ? vec2(1.0 + turn.x, turn.y) : vec2(abs(turn.y), way * (1.0 - turn.x)));
    vec3 wide = turn.x * x + turn.y * y;
    return mat3(wide, cross(axis, wide), axis);
}

float ellipse_irradiance(vec3 centre, vec3 u, vec3 v, vec3 n, vec3 normal) {
    vec2 rise = vec2(dot(n, u), dot(n, v));
    float middle = dot(n, centre), reach = length(rise);
    if (middle <= -reach) return 0.0;
    vec3 a = cross(v, centre), b = cross(centre, u), c = cross(u, v);
    float square = dot(centre, centre), volume = dot(centre, c);
    float p = dot(u, u) + dot(v, v) - square, q = dot(c, c) - dot(a, a) - dot(b, b), r = volume * volume;
    float m = positive_root(square, p, q, r);
    float slope = (3.0 * m + 2.0 * p) * m + q; // (m + m wide^2) (m + m narrow^2)
    vec3 t = centre * inversesqrt(square) - normal; // no right angle with the cone's axis
    vec3 s = u * dot(u, t) + v * dot(v, t) - centre * dot(centre, t);
    vec3 axis = normalize(m * ((m + p) * t - s) + c * dot(c, t) - a * dot(a, t) - b * dot(b, t));
    if (middle >= reach) return 3.141592653589793 * dot(n, axis) * sqrt(r / (m * slope));
    float level = middle / reach;
    bool small = max(dot(u, u), dot(v, v)) < 1e-2 * square; // its rim's two ends would cancel
    float sent = abs(volume) * small_clipped_ellipse(centre, u, v, rise / reach, level, reach, small ? 6 : 0);
    if (small) return sent;
    float most;
    mat3 frame = principal_axes(axis, centre, u, v, most);
    float side = volume < 0.0 ? -1.0 : 1.0; // the rim's sense, seen from the receiver
    vec2 half_lengths = sqrt(vec2(most, r / (m * most)) / m);
    return clipped_ellipse(centre, u, side * v, n, vec2(rise.x, side * rise.y) / reach, level, frame, half_lengths);
}
