// The color that transparent surfaces give to what the camera sees through them.
#if TINTED
#include "textures/fine_pixel.glsl"
uniform sampler2D transmitted_color;
#endif

struct Tint {
    vec3 color;
    float depth; // along the view's axis, of the nearest surface that gives it, m
};
const Tint NO_TINT = Tint(vec3(1.0), 0.0);

// Of a pixel's sample: see fine_pixel.
Tint tint_at(vec2 pixel, vec2 texel) {
#if TINTED
    vec4 fetched = fetch(transmitted_color, fine_pixel(pixel, texel));
    return Tint(fetched.rgb, -fetched.a);
#else
    return NO_TINT;
#endif
}
