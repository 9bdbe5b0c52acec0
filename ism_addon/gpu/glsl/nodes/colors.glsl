// Operations of nodes that change colours. See shading/colors.py.
#include "nodes/arithmetic.glsl"

vec3 blend_mix(float t, vec3 a, vec3 b) { return mix(a, b, t); }
vec3 blend_darken(float t, vec3 a, vec3 b) { return mix(a, min(a, b), t); }
vec3 blend_multiply(float t, vec3 a, vec3 b) { return mix(a, a * b, t); }
vec3 blend_lighten(float t, vec3 a, vec3 b) { return mix(a, max(a, b), t); }
vec3 blend_screen(float t, vec3 a, vec3 b) { return 1.0 - (1.0 - t + t * (1.0 - b)) * (1.0 - a); }
vec3 blend_add(float t, vec3 a, vec3 b) { return mix(a, a + b, t); }
vec3 blend_linear_light(float t, vec3 a, vec3 b) { return a + t * (2.0 * b - 1.0); }
vec3 blend_difference(float t, vec3 a, vec3 b) { return mix(a, abs(a - b), t); }
vec3 blend_exclusion(float t, vec3 a, vec3 b) { return max(mix(a, a + b - 2.0 * a * b, t), 0.0); }
vec3 blend_subtract(float t, vec3 a, vec3 b) { return mix(a, a - b, t); }

vec3 blend_soft_light(float t, vec3 a, vec3 b) {
    return mix(a, (1.0 - a) * b * a + a * (1.0 - (1.0 - b) * (1.0 - a)), t);
}

vec3 blend_overlay(float t, vec3 a, vec3 b) {
    vec3 dark = a * (1.0 - t + 2.0 * t * b), bright = 1.0 - (1.0 - t + 2.0 * t * (1.0 - b)) * (1.0 - a);
    return mix(bright, dark, lessThan(a, vec3(0.5)));
}

float dodge(float t, float a, float b) {
    float divisor = 1.0 - t * b;
    return a == 0.0 ? 0.0 : divisor <= 0.0 ? 1.0 : min(a / divisor, 1.0);
}

vec3 blend_dodge(float t, vec3 a, vec3 b) { return vec3(dodge(t, a.x, b.x), dodge(t, a.y, b.y), dodge(t, a.z, b.z)); }

float burn(float t, float a, float b) {
    float divisor = 1.0 - t + t * b;
    return divisor <= 0.0 ? 0.0 : clamp(1.0 - (1.0 - a) / divisor, 0.0, 1.0);
}

vec3 blend_burn(float t, vec3 a, vec3 b) { return vec3(burn(t, a.x, b.x), burn(t, a.y, b.y), burn(t, a.z, b.z)); }

vec3 blend_divide(float t, vec3 a, vec3 b) {
    bvec3 is_zero = equal(b, vec3(0.0));
    return mix((1.0 - t) * a + t * a / mix(b, vec3(1.0), is_zero), a, is_zero);
}

// Colours may be brighter than 1.
vec3 hsv_from_rgb(vec3 rgb) {
    float high = max(max(rgb.r, rgb.g), rgb.b), delta = high - min(min(rgb.r, rgb.g), rgb.b);
    if (delta == 0.0 || high == 0.0) return vec3(0.0, 0.0, high);
    vec3 below = (high - rgb) / delta;
    float hue = rgb.r == high ? below.b - below.g : rgb.g == high ? 2.0 + below.r - below.b : 4.0 + below.g - below.r;
    return vec3(fract(hue / 6.0), delta / high, high);
}

vec3 pure_hue(float hue) { return clamp(abs(mod(hue * 6.0 + vec3(0.0, 4.0, 2.0), 6.0) - 3.0) - 1.0, 0.0, 1.0); }
vec3 rgb_from_hsv(vec3 hsv) { return hsv.z * (1.0 - hsv.y * (1.0 - pure_hue(hsv.x))); }

// Of colours brighter than 1 only the lightness is limited.
vec3 hsl_from_rgb(vec3 rgb) {
    float high = max(max(rgb.r, rgb.g), rgb.b), low = min(min(rgb.r, rgb.g), rgb.b);
    float lightness = min(0.5 * (high + low), 1.0), delta = high - low;
    float most = lightness > 0.5 ? 2.0 - high - low : high + low;
    return delta != 0.0 && most != 0.0 ? vec3(hsv_from_rgb(rgb).x, delta / most, lightness)
                                       : vec3(0.0, 0.0, lightness);
}

vec3 rgb_from_hsl(vec3 hsl) { return (pure_hue(hsl.x) - 0.5) * ((1.0 - abs(2.0 * hsl.z - 1.0)) * hsl.y) + hsl.z; }

vec3 blend_hue(float t, vec3 a, vec3 b) {
    vec3 hsv = hsv_from_rgb(b);
    return hsv.y == 0.0 ? a : mix(a, rgb_from_hsv(vec3(hsv.x, hsv_from_rgb(a).yz)), t);
}

vec3 blend_saturation(float t, vec3 a, vec3 b) {
    vec3 hsv = hsv_from_rgb(a);
    return hsv.y == 0.0 ? a : rgb_from_hsv(vec3(hsv.x, mix(hsv.y, hsv_from_rgb(b).y, t), hsv.z));
}

vec3 blend_value(float t, vec3 a, vec3 b) {
    vec3 hsv = hsv_from_rgb(a);
    return rgb_from_hsv(vec3(hsv.xy, mix(hsv.z, hsv_from_rgb(b).z, t)));
}

vec3 blend_color(float t, vec3 a, vec3 b) {
    vec3 hsv = hsv_from_rgb(b);
    return hsv.y == 0.0 ? a : mix(a, rgb_from_hsv(vec3(hsv.xy, hsv_from_rgb(a).z)), t);
}

vec3 hue_saturation(float hue, float saturation, float value, float t, vec3 color) {
    vec3 hsv = hsv_from_rgb(color);
    vec3 changed = vec3(fract(hsv.x + hue + 0.5), saturate(hsv.y * saturation), hsv.z * value);
    return max(mix(color, rgb_from_hsv(changed), t), 0.0);
}

float largest(vec3 a) { return max(a.x, max(a.y, a.z)); }
float average(vec3 a) { return (a.x + a.y + a.z) / 3.0; }
vec3 grey(float a) { return vec3(a); }
vec3 color_of(vec4 a) { return a.rgb; }
float alpha_of(vec4 a) { return a.a; }
vec3 invert(float t, vec3 a) { return mix(a, 1.0 - a, t); }

vec3 gamma(vec3 color, float exponent) {
    vec3 result = mix(color, pow(max(color, 1e-30), vec3(exponent)), greaterThan(color, vec3(0.0)));
    return exponent == 0.0 ? vec3(1.0) : result;
}

vec3 bright_contrast(vec3 a, float bright, float contrast) {
    return max((1.0 + contrast) * a + bright - contrast * 0.5, 0.0);
}
