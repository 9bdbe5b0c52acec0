// Operations of procedural textures that are patterns. See shading/patterns.py.
#include "nodes/vectors.glsl"

const float CIRCLE = radians(360.0);
const float WAVE_FREQUENCY = 20.0;
const int POSITIVE = 0x7fffffff;

vec3 off_integers(vec3 p) { return (p + 1e-6) * 0.999999; }
float wave_bands(vec3 p, vec3 direction) { return WAVE_FREQUENCY * dot(p, direction); }
float wave_rings(vec3 p, vec3 axes) { return WAVE_FREQUENCY * length(p * axes); }
float wave_sin(float phase) { return 0.5 - 0.5 * cos(phase); }
float wave_saw(float phase) { return math_fract(phase / CIRCLE); }

float wave_tri(float phase) {
    float periods = phase / CIRCLE;
    return 2.0 * abs(periods - floor(periods + 0.5));
}

vec3 magic(vec3 p, float scale, float depth, float distortion) {
    vec3 angles = vector_modulo(p, vec3(CIRCLE)) * 5.0 * scale;
    float x = angles.x, y = angles.y, z = angles.z;
    vec3 v = vec3(sin(x + y + z), cos(-x + y - z), -cos(-x - y + z));
    if (depth > 0.0) v *= distortion;
    if (depth > 0.0) v.y = distortion * -cos(v.x - v.y + v.z);
    if (depth > 1.0) v.x = distortion * cos(v.x - v.y - v.z);
    if (depth > 2.0) v.z = distortion * -sin(v.x + v.y + v.z);
    if (depth > 3.0) v.x = distortion * -cos(v.x - v.y + v.z);
    if (depth > 4.0) v.y = distortion * sin(v.x - v.y - v.z);
    if (depth > 5.0) v.y = distortion * -cos(v.x - v.y - v.z);
    if (depth > 6.0) v.x = distortion * cos(v.x + v.y + v.z);
    if (depth > 7.0) v.z = distortion * sin(v.x + v.y - v.z);
    if (depth > 8.0) v.x = distortion * -cos(v.x + v.y - v.z);
    if (depth > 9.0) v.y = distortion * -sin(v.x - v.y + v.z);
    return 0.5 - (distortion != 0.0 ? v / (2.0 * distortion) : v);
}

float checker(vec3 p) {
    vec3 cell = floor(p);
    return float(mod(mod(cell.x, 2.0) + mod(cell.y, 2.0) + mod(cell.z, 2.0), 2.0) == 1.0);
}

float brick_random(int row, int column) {
    int n = ((row << 16) + (column & 0xffff) + 1013) & POSITIVE;
    n ^= n >> 13;
    return float((n * (n * n * 60493 + 19990303) + 1376312589) & POSITIVE) / float(POSITIVE);
}

vec3 brick(vec3 p, float bias, float width, float height, float offset, float squash, float mortar_size,
           float mortar_smooth, float offset_frequency, float squash_frequency) {
    int row = int(floor(math_divide(p.y, height))), size = abs(row); // % is undefined for negative numbers
    float along = p.x;
    int offset_rows = abs(int(offset_frequency)), squash_rows = abs(int(squash_frequency));
    if (offset_rows > 0 && squash_rows > 0) {
        if (size % squash_rows == 0) width *= squash;
        if (size % offset_rows == 0) along += width * offset;
    }
    int column = int(floor(math_divide(along, width)));
    float x = along - width * float(column), y = p.y - height * float(row);
    float distance = min(min(x, y), min(width - x, height - y)), mortar = 0.0;
    if (distance < mortar_size)
        mortar = mortar_smooth != 0.0 ? fraction_smoothstep(1.0 - distance / mortar_size, 0.0, mortar_smooth) : 1.0;
    return vec3(saturate(brick_random(row, column) + bias), mortar, 0.0);
}

float gradient_linear(vec3 p) { return saturate(p.x); }
float gradient_quadratic(vec3 p) { return saturate(p.x > 0.0 ? p.x * p.x : 0.0); }
float gradient_easing(vec3 p) { return fraction_smoothstep(p.x, 0.0, 1.0); }
float gradient_diagonal(vec3 p) { return saturate(0.5 * (p.x + p.y)); }
float gradient_radial(vec3 p) { return saturate(math_arctan2(p.y, p.x) / CIRCLE + 0.5); }
float gradient_spherical(vec3 p) { return saturate(0.999999 - length(p)); }

float gradient_quadratic_sphere(vec3 p) {
    float within = gradient_spherical(p);
    return within * within;
}
