// Filtered look-up in an image. The texels of its mip levels are stored one after another, WIDTH texels to a line.
// There is one texture for each encoding.
uniform usamplerBuffer images;
uniform sampler2D srgb_texels;
uniform sampler2D linear_texels;
uniform sampler2D float_texels;

// What is beyond an image's border.
const int REPEAT = 0, EXTEND = 1, CLIP = 2, MIRROR = 3;

struct MipLevel { int first; ivec2 size; }; // index of its first texel

MipLevel halved(MipLevel level) {
    return MipLevel(level.first + level.size.x * level.size.y, max(level.size >> 1, ivec2(1)));
}

MipLevel mip_level(Image image, int index) {
    MipLevel level = MipLevel(0, ivec2(image.width, image.height));
    for (int k = 1; k <= index; ++k) level = halved(level);
    return level;
}

// The level, with a fraction, whose texels are as large as the shorter side of a footprint: the derivatives of uv by
// pixel. Along the longer side the mean of samples filters.
float footprint_level(Image image, vec2 dx, vec2 dy) {
    vec2 size = vec2(image.width, image.height);
    float footprint = min(length(dx * size), length(dy * size));
    return clamp(log2(max(footprint, 1e-6)), 0.0, float(image.levels - 1));
}

vec4 texel(Image image, MipLevel level, ivec2 texel) {
    int index = level.first + texel.y * level.size.x + texel.x;
    ivec2 at = ivec2(index % WIDTH, image.first_line + index / WIDTH);
    vec4 color = vec4(0.0);
#if SRGB_IMAGES
    if (image.encoding == 0) color = fetch(srgb_texels, at);
#endif
#if LINEAR_IMAGES
    if (image.encoding == 1) color = fetch(linear_texels, at);
#endif
#if FLOAT_IMAGES
    if (image.encoding == 2) color = fetch(float_texels, at);
#endif
    return color;
}

// The part of a texture coordinate that is within the image, or less than a texel beside it.
vec2 inside_image(vec2 uv, int extension) {
    if (extension == REPEAT) return fract(uv);
    if (extension == MIRROR) return 1.0 - abs(mod(uv, 2.0) - 1.0);
    return clamp(uv, extension == CLIP ? -1.0 : 0.0, extension == CLIP ? 2.0 : 1.0);
}

// A texel which may be beside the image.
vec4 extended_texel(Image image, MipLevel level, ivec2 at, int extension) {
    ivec2 last = level.size - 1, within = clamp(at, ivec2(0), last);
    if (extension == REPEAT)
        within = at + level.size * (ivec2(lessThan(at, ivec2(0))) - ivec2(greaterThan(at, last)));
    vec4 color = texel(image, level, within);
    return extension == CLIP && within != at ? vec4(0.0) : color;
}

vec4 bilinear(Image image, MipLevel level, vec2 uv, int extension) {
    vec2 at = inside_image(uv, extension) * vec2(level.size) - 0.5, corner = floor(at), f = at - corner;
    ivec2 low = ivec2(corner);
    vec4 colors[4];
    for (int k = 0; k < 4; ++k)
        colors[k] = extended_texel(image, level, low + ivec2(k & 1, k >> 1), extension);
    return mix(mix(colors[0], colors[1], f.x), mix(colors[2], colors[3], f.x), f.y);
}

// dx, dy: derivatives of uv by pixel.
vec4 image_color(Image image, vec2 uv, vec2 dx, vec2 dy, int extension) {
    float level = footprint_level(image, dx, dy);
    MipLevel fine = mip_level(image, int(level));
    vec4 color = bilinear(image, fine, uv, extension);
    return level < float(image.levels - 1) ? mix(color, bilinear(image, halved(fine), uv, extension), fract(level))
                                           : color;
}
