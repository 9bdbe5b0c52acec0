// Operations of the nodes Math, Map Range, Clamp and Mix of numbers. See shading/arithmetic.py.

float math_add(float a, float b) { return a + b; }
float math_subtract(float a, float b) { return a - b; }
float math_multiply(float a, float b) { return a * b; }
float math_multiply_add(float a, float b, float c) { return a * b + c; }
float math_divide(float a, float b) { return b != 0.0 ? a / b : 0.0; }
float math_minimum(float a, float b) { return min(a, b); }
float math_maximum(float a, float b) { return max(a, b); }
float math_less_than(float a, float b) { return float(a < b); }
float math_greater_than(float a, float b) { return float(a > b); }

// pow() is undefined for negative numbers.
float math_power(float a, float b) {
    if (a < 0.0 && b != trunc(b) || a == 0.0 && b < 0.0) return 0.0;
    if (b == 0.0) return 1.0;
    float size = pow(abs(a), b);
    return a < 0.0 && mod(b, 2.0) != 0.0 ? -size : size;
}

float math_logarithm(float a, float b) {
    return a > 0.0 && b > 0.0 ? math_divide(log(a), log(b)) : 0.0;
}

float math_sqrt(float a) { return sqrt(max(a, 0.0)); }
float math_inverse_sqrt(float a) { return a > 0.0 ? inversesqrt(a) : 0.0; }
float math_absolute(float a) { return abs(a); }
float math_exponent(float a) { return exp(a); }
float math_sign(float a) { return sign(a); }
float math_round(float a) { return floor(a + 0.5); }
float math_floor(float a) { return floor(a); }
float math_ceil(float a) { return ceil(a); }
float math_trunc(float a) { return trunc(a); }
float math_fract(float a) { return a - floor(a); }
float math_modulo(float a, float b) { return b != 0.0 ? a - b * trunc(a / b) : 0.0; }
float math_floored_modulo(float a, float b) { return b != 0.0 ? a - b * floor(a / b) : 0.0; }
float math_snap(float a, float b) { return floor(math_divide(a, b)) * b; }

float math_wrap(float a, float high, float low) {
    float range = high - low;
    return range != 0.0 ? a - range * floor((a - low) / range) : low;
}

float math_pingpong(float a, float b) {
    return b != 0.0 ? abs(math_fract((a - b) / (2.0 * b)) * 2.0 * b - b) : 0.0;
}

float math_compare(float a, float b, float c) { return float(abs(a - b) <= max(c, 1e-5)); }

float math_smooth_min(float a, float b, float distance) {
    float h = distance != 0.0 ? max(distance - abs(a - b), 0.0) / distance : 0.0;
    return min(a, b) - h * h * h * distance / 6.0;
}

float math_smooth_max(float a, float b, float distance) { return -math_smooth_min(-a, -b, distance); }
float math_sine(float a) { return sin(a); }
float math_cosine(float a) { return cos(a); }
float math_tangent(float a) { return tan(a); }
float math_arcsine(float a) { return asin(clamp(a, -1.0, 1.0)); }
float math_arccosine(float a) { return acos(clamp(a, -1.0, 1.0)); }
float math_arctangent(float a) { return atan(a); }
float math_arctan2(float a, float b) { return a == 0.0 && b == 0.0 ? 0.0 : atan(a, b); }
float math_sinh(float a) { return sinh(a); }
float math_cosh(float a) { return cosh(a); }
float math_tanh(float a) { return tanh(clamp(a, -20.0, 20.0)); }
float math_radians(float a) { return radians(a); }
float math_degrees(float a) { return degrees(a); }
float saturate(float a) { return clamp(a, 0.0, 1.0); }
float clamp_minmax(float a, float low, float high) { return min(max(a, low), high); }
float clamp_range(float a, float one, float other) { return clamp(a, min(one, other), max(one, other)); }
float fraction_linear(float a, float low, float high) { return math_divide(a - low, high - low); }

float fraction_stepped(float a, float low, float high, float steps) {
    return steps > 0.0 ? floor(fraction_linear(a, low, high) * (steps + 1.0)) / steps : 0.0;
}

float fraction_smoothstep(float a, float low, float high) {
    float t = saturate(fraction_linear(a, low, high));
    return t * t * (3.0 - 2.0 * t);
}

float fraction_smootherstep(float a, float low, float high) {
    float t = saturate(fraction_linear(a, low, high));
    return t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
}

float mix_float(float t, float a, float b) { return a * (1.0 - t) + b * t; }
