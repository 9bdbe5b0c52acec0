// The node Image Texture. dx, dy: differences of the vector between pixels.
#include "textures/image.glsl"

vec4 image_linear(float image, vec3 at, vec3 dx, vec3 dy, int extension) {
    return image_color(image_at(int(image)), at.xy, dx.xy, dy.xy, extension);
}

vec4 image_closest(float image, vec3 at, vec3 dx, vec3 dy, int extension) {
    Image one = image_at(int(image));
    MipLevel level = mip_level(one, int(footprint_level(one, dx.xy, dy.xy)));
    ivec2 texel = ivec2(floor(inside_image(at.xy, extension) * vec2(level.size)));
    return decoded(one, extended_texel(one, level, texel, extension));
}

// By cubic B-splines.
vec4 image_cubic(float image, vec3 at, vec3 dx, vec3 dy, int extension) {
    Image one = image_at(int(image));
    MipLevel level = mip_level(one, int(footprint_level(one, dx.xy, dy.xy)));
    vec2 place = inside_image(at.xy, extension) * vec2(level.size) - 0.5, corner = floor(place), f = place - corner;
    vec2 g = 1.0 - f;
    vec2 weights[4] = vec2[4](g * g * g / 6.0, 2.0 / 3.0 - 0.5 * f * f * (2.0 - f), 2.0 / 3.0 - 0.5 * g * g * (2.0 - g),
                              f * f * f / 6.0);
    vec4 sum = vec4(0.0);
    for (int y = 0; y < 4; ++y)
        for (int x = 0; x < 4; ++x)
            sum += weights[x].x * weights[y].y *
                   extended_texel(one, level, ivec2(corner) + ivec2(x, y) - 1, extension);
    return decoded(one, sum);
}

const int CLOSEST = 1, CUBIC = 2; // interpolations, other than linear
const int EXTENSIONS = 4;
const float HALF_CIRCLE = radians(180.0);

// `sampling`: the interpolation, times EXTENSIONS, and the extension.
vec4 image_interpolated(float image, vec3 at, vec3 dx, vec3 dy, int sampling) {
    int interpolation = sampling / EXTENSIONS, extension = sampling % EXTENSIONS;
    if (interpolation == CLOSEST) return image_closest(image, at, dx, dy, extension);
    if (interpolation == CUBIC) return image_cubic(image, at, dx, dy, extension);
    return image_linear(image, at, dx, dy, extension);
}

// Longitudes on both sides of the seam are next to each other.
vec3 around(vec3 difference) { return vec3(difference.x - round(difference.x), difference.yz); }
