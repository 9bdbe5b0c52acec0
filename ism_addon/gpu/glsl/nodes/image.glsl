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
