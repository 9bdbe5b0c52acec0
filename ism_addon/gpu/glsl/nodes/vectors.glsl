// Operations of the nodes Vector Math, Map Range and Mix of vectors, Mapping and Vector Rotate. See shading/vectors.py.
#include "nodes/arithmetic.glsl"

// Bodies of functions that apply a function of numbers to each component.
#define BY_COMPONENT_2(number) { return vec3(number(a.x, b.x), number(a.y, b.y), number(a.z, b.z)); }
#define BY_COMPONENT_3(number) { return vec3(number(a.x, b.x, c.x), number(a.y, b.y, c.y), number(a.z, b.z, c.z)); }

vec3 vector_add(vec3 a, vec3 b) { return a + b; }
vec3 vector_subtract(vec3 a, vec3 b) { return a - b; }
vec3 vector_multiply(vec3 a, vec3 b) { return a * b; }
vec3 vector_multiply_add(vec3 a, vec3 b, vec3 c) { return a * b + c; }
vec3 vector_scale(vec3 a, float scale) { return a * scale; }
vec3 vector_minimum(vec3 a, vec3 b) { return min(a, b); }
vec3 vector_maximum(vec3 a, vec3 b) { return max(a, b); }
vec3 vector_absolute(vec3 a) { return abs(a); }
vec3 vector_floor(vec3 a) { return floor(a); }
vec3 vector_ceil(vec3 a) { return ceil(a); }
vec3 vector_fraction(vec3 a) { return a - floor(a); }
vec3 vector_sine(vec3 a) { return sin(a); }
vec3 vector_cosine(vec3 a) { return cos(a); }
vec3 vector_tangent(vec3 a) { return tan(a); }
vec3 vector_sign(vec3 a) { return sign(a); }
vec3 vector_saturate(vec3 a) { return clamp(a, 0.0, 1.0); }
vec3 vector_divide(vec3 a, vec3 b) BY_COMPONENT_2(math_divide)
vec3 vector_modulo(vec3 a, vec3 b) BY_COMPONENT_2(math_modulo)
vec3 vector_snap(vec3 a, vec3 b) BY_COMPONENT_2(math_snap)
vec3 vector_power(vec3 a, vec3 b) BY_COMPONENT_2(math_power)
vec3 vector_wrap(vec3 a, vec3 b, vec3 c) BY_COMPONENT_3(math_wrap)
vec3 vector_fraction_linear(vec3 a, vec3 b, vec3 c) BY_COMPONENT_3(fraction_linear)
vec3 vector_fraction_smoothstep(vec3 a, vec3 b, vec3 c) BY_COMPONENT_3(fraction_smoothstep)
vec3 vector_fraction_smootherstep(vec3 a, vec3 b, vec3 c) BY_COMPONENT_3(fraction_smootherstep)
vec3 vector_clamp_range(vec3 a, vec3 b, vec3 c) BY_COMPONENT_3(clamp_range)
vec3 mix_by_component(vec3 a, vec3 b, vec3 c) BY_COMPONENT_3(mix_float)

vec3 vector_fraction_stepped(vec3 a, vec3 low, vec3 high, vec3 steps) {
    return vec3(fraction_stepped(a.x, low.x, high.x, steps.x), fraction_stepped(a.y, low.y, high.y, steps.y),
                fraction_stepped(a.z, low.z, high.z, steps.z));
}

vec3 combine_xyz(float x, float y, float z) { return vec3(x, y, z); }
float separate_x(vec3 a) { return a.x; }
float separate_y(vec3 a) { return a.y; }
float separate_z(vec3 a) { return a.z; }
float vector_dot_product(vec3 a, vec3 b) { return dot(a, b); }
float vector_distance(vec3 a, vec3 b) { return distance(a, b); }
float vector_length(vec3 a) { return length(a); }
vec3 vector_cross_product(vec3 a, vec3 b) { return cross(a, b); }

vec3 vector_normalize(vec3 a) {
    float size = length(a);
    return size > 0.0 ? a / size : vec3(0.0);
}

vec3 vector_project(vec3 a, vec3 b) {
    float square = dot(b, b);
    return square > 0.0 ? dot(a, b) / square * b : vec3(0.0);
}

vec3 vector_reflect(vec3 a, vec3 b) { return reflect(a, vector_normalize(b)); }
vec3 vector_refract(vec3 a, vec3 b, float ior) { return refract(a, vector_normalize(b), ior); }
vec3 vector_faceforward(vec3 a, vec3 b, vec3 c) { return dot(b, c) < 0.0 ? a : -a; }
vec3 mix_vector(float t, vec3 a, vec3 b) { return a * (1.0 - t) + b * t; }

// Rotation by Euler angles in the order XYZ.
mat3 euler_matrix(vec3 angles) {
    vec3 c = cos(angles), s = sin(angles);
    return mat3(c.y * c.z, c.y * s.z, -s.y,
                s.x * s.y * c.z - c.x * s.z, s.x * s.y * s.z + c.x * c.z, s.x * c.y,
                c.x * s.y * c.z + s.x * s.z, c.x * s.y * s.z - s.x * c.z, c.x * c.y);
}

vec3 mapping_point(vec3 v, vec3 location, vec3 rotation, vec3 scale) {
    return euler_matrix(rotation) * (v * scale) + location;
}

vec3 mapping_texture(vec3 v, vec3 location, vec3 rotation, vec3 scale) {
    return vector_divide((v - location) * euler_matrix(rotation), scale);
}

vec3 mapping_vector(vec3 v, vec3 location, vec3 rotation, vec3 scale) { return euler_matrix(rotation) * (v * scale); }

vec3 mapping_normal(vec3 v, vec3 location, vec3 rotation, vec3 scale) {
    return vector_normalize(euler_matrix(rotation) * vector_divide(v, scale));
}

vec3 rotate_euler(vec3 v, vec3 centre, vec3 angles) { return euler_matrix(angles) * (v - centre) + centre; }
vec3 rotate_euler_inverse(vec3 v, vec3 centre, vec3 angles) { return (v - centre) * euler_matrix(angles) + centre; }

// About an axis of any length (Rodrigues).
vec3 rotate_axis(vec3 v, vec3 centre, vec3 axis, float angle) {
    vec3 n = vector_normalize(axis), offset = v - centre;
    if (n == vec3(0.0)) return v;
    return offset * cos(angle) + cross(n, offset) * sin(angle) + n * dot(n, offset) * (1.0 - cos(angle)) + centre;
}
