// Irradiance of an ellipse of radiance 1 in closed form, by the principal axes of its cone, see radiometry.py.
#include "maths/atan2.glsl"

// The only positive root of x^3 + p x^2 + q x - r, whose roots are all real, by Laguerre's method, which starts at an x
// above it. The root of the polynomial without x^3 is also an upper bound, a tight one near the light.
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
float atan_difference(float k, vec2 x) {
    float step = x.y - x.x;
    return k > 1e-4 ? sign(step) * atan2_accurate(k * abs(step), 1.0 + k * k * x.x * x.y) / k : step;
}

// (atanh(k x.y) - atanh(k x.x)) / k, given roots = sqrt(1 - k^2 x^2).
float atanh_difference(float k, vec2 x, vec2 roots) {
    float step = (x.y - x.x) / (1.0 - k * k * x.x * x.y), s = k * k * step * step;
    if (s < 0.06) return step * ((((s / 9.0 + 1.0 / 7.0) * s + 1.0 / 5.0) * s + 1.0 / 3.0) * s + 1.0);
    vec2 size = (1.0 + k * abs(x)) / roots;
    return log((x.y < 0.0 ? 1.0 / size.y : size.y) * (x.x < 0.0 ? size.x : 1.0 / size.x)) / k;
}

// Lambert's boundary integral along the cone (wide cos t, narrow sin t, 1), from one of its points to another.
float boundary_integral(vec3 n, float wide, float narrow, vec3 from, vec3 to) {
    float a = 1.0 + wide * wide, b = 1.0 + narrow * narrow, k = sqrt(max(a - b, 0.0));
    vec2 scale = vec2(inversesqrt(a), inversesqrt(b));
    vec2 cosines = vec2(from.x / from.z, to.x / to.z) / wide, sines = vec2(from.y / from.z, to.y / to.z) / narrow;
    vec2 p = vec2(cosines.x, sines.x) / scale, q = vec2(cosines.y, sines.y) / scale;
    float angle = atan2_accurate(abs(p.x * q.y - p.y * q.x), dot(p, q));
    if (p.x * q.y < p.y * q.x) angle = 6.283185307179586 - angle;
    vec2 roots = vec2(length(from) / from.z, length(to) / to.z) * scale.x;
    return n.z * wide * narrow * angle * scale.x * scale.y
         - n.x * narrow * scale.x * atanh_difference(k, sines * scale.x, roots)
         + n.y * wide * scale.y * atan_difference(k, cosines * scale.y);
}

// The irradiance of a small ellipse cut by the horizon, without the factor cross(u, v): two points on each of several
// chords along the horizon. `direction` and `level` as in clipped_ellipse; `amplitude` is half the range of heights.
float small_clipped_ellipse(vec3 centre, vec3 u, vec3 v, vec2 direction, float level, float amplitude, int points) {
    const vec3 NODES = vec3(0.2386191861, 0.6612093865, 0.9324695142); // Gauss-Legendre quadrature
    const vec3 WEIGHTS = vec3(0.4679139346, 0.3607615730, 0.1713244924);
    vec3 up = u * direction.x + v * direction.y, across = (v * direction.x - u * direction.y) * 0.5773502692;
    float angle = atan2_accurate(sqrt(1.0 - level * level), -level), sum = 0.0;
    for (int k = 0; k < points; ++k) { // over the angle at which a chord ends
        float t = 0.5 * angle * (1.0 + (k % 2 == 0 ? NODES[k / 2] : -NODES[k / 2])), sine = sin(t);
        vec3 middle = centre + cos(t) * up, first = middle - sine * across, second = middle + sine * across;
        float a = 1.0 / dot(first, first), b = 1.0 / dot(second, second);
        sum += WEIGHTS[k / 2] * (level + cos(t)) * sine * sine * (a * a + b * b);
    }
    return 0.5 * angle * amplitude * sum;
}

// The irradiance of the region above the horizon. Heights over the horizon are in units of their amplitude on the
// ellipse: `level` is the centre's, -1 to 1; a point at centre + x u + y v has level + dot(direction, (x, y)),
// |direction| = 1.
float clipped_ellipse(vec3 centre, vec3 u, vec3 v, vec3 n, vec2 direction, float level, mat3 frame, vec2 half_lengths) {
    float across = sqrt(1.0 - level * level);
    vec2 x = -level * direction, y = across * vec2(-direction.y, direction.x);
    vec3 from = centre + u * (x.x - y.x) + v * (x.y - y.y), to = centre + u * (x.x + y.x) + v * (x.y + y.y);
    float chord = atan2_accurate(length(cross(from, to)), dot(from, to));
    float boundary = boundary_integral(n * frame, half_lengths.x, half_lengths.y, from * frame, to * frame);
    return 0.5 * max(chord + boundary, 0.0);
}

// The cone's wide, narrow and given axis. The first two are eigenvectors of S (see radiometry.py) restricted to the
// plane perpendicular to the given axis; `largest` is the eigenvalue of the wide one.
mat3 principal_axes(vec3 axis, vec3 centre, vec3 u, vec3 v, out float largest) {
    vec3 x = normalize(abs(axis.x) < 0.5 ? vec3(0.0, axis.z, -axis.y) : vec3(-axis.z, 0.0, axis.x)), y = cross(axis, x);
    vec3 on_x = vec3(dot(u, x), dot(v, x), dot(centre, x)), on_y = vec3(dot(u, y), dot(v, y), dot(centre, y));
    vec3 signs = vec3(1.0, 1.0, -1.0);
    float xx = dot(on_x * signs, on_x), xy = dot(on_x * signs, on_y), yy = dot(on_y * signs, on_y);
    vec2 difference = vec2(xx - yy, 2.0 * xy);
    float gap = length(difference);
    largest = 0.5 * (xx + yy + gap);
    vec2 twice = gap > 0.0 ? difference / gap : vec2(1.0, 0.0); // cosine and sine of twice the wide axis' angle
    float side = twice.y < 0.0 ? -1.0 : 1.0;
    vec2 d = normalize(twice.x > 0.0 ? vec2(1.0 + twice.x, twice.y) : vec2(abs(twice.y), side * (1.0 - twice.x)));
    vec3 wide = d.x * x + d.y * y;
    return mat3(wide, cross(axis, wide), axis);
}

// `centre`: from the receiver to the light; u, v: semi-axes; n: the receiver's normal; `normal`: the light's.
float ellipse_irradiance(vec3 centre, vec3 u, vec3 v, vec3 n, vec3 normal) {
    vec2 heights = vec2(dot(n, u), dot(n, v));
    float height = dot(n, centre), amplitude = length(heights);
    if (height <= -amplitude) return 0.0;
    vec3 a = cross(v, centre), b = cross(centre, u), c = cross(u, v);
    float square = dot(centre, centre), volume = dot(centre, c);
    float p = dot(u, u) + dot(v, v) - square, q = dot(c, c) - dot(a, a) - dot(b, b), r = volume * volume;
    float m = positive_root(square, p, q, r);
    float slope = (3.0 * m + 2.0 * p) * m + q; // (m + m wide^2) (m + m narrow^2)
    vec3 t = centre * inversesqrt(square) - normal; // never perpendicular to the cone's axis
    vec3 s = u * dot(u, t) + v * dot(v, t) - centre * dot(centre, t);
    vec3 axis = normalize(m * ((m + p) * t - s) + c * dot(c, t) - a * dot(a, t) - b * dot(b, t));
    if (height >= amplitude) return 3.141592653589793 * dot(n, axis) * sqrt(r / (m * slope));
    float level = height / amplitude;
    bool small = max(dot(u, u), dot(v, v)) < 1e-2 * square; // the boundary integral would cancel
    float irradiance =
        abs(volume) * small_clipped_ellipse(centre, u, v, heights / amplitude, level, amplitude, small ? 6 : 0);
    if (small) return irradiance;
    float largest;
    mat3 frame = principal_axes(axis, centre, u, v, largest);
    float side = volume < 0.0 ? -1.0 : 1.0; // the boundary's orientation as seen from the receiver
    vec2 half_lengths = sqrt(vec2(largest, r / (m * largest)) / m);
    vec2 direction = vec2(heights.x, side * heights.y) / amplitude;
    return clipped_ellipse(centre, u, side * v, n, direction, level, frame, half_lengths);
}
