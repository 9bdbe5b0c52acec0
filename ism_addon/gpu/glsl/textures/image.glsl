// Filtered look-up in an image. The texels of its mip levels are stored one after another, WIDTH texels to a line, and
// LAYER_LINES lines to a layer.
#ifdef IN_SCENE_RECORDS
#include "textures/scene_records.glsl"
uniform int images;
Image image_at(int index) { return fetch_Image(scene_records, images + index); }
#else
uniform usamplerBuffer images;
Image image_at(int index) { return fetch_Image(images, index); }
#endif
uniform sampler2DArray byte_texels;
uniform sampler2DArray float_texels;

// Of Image.encoding.
const int SRGB_BYTES = 0, LINEAR_BYTES = 1, FLOATS = 2;

// What is beyond an image's border.
const int REPEAT = 0, EXTEND = 1, CLIP = 2, MIRROR = 3;

struct MipLevel { int first; ivec2 size; }; // index of its first texel

MipLevel halved(MipLevel level) {
    return MipLevel(level.first + level.size.x * level.size.y, max(level.size >> 1, ivec2(1)));
}

// From the table: with a loop here, Mesa's software driver takes minutes to compile a graph of several images.
MipLevel mip_level(Image image, int index) {
    Image level = image_at(image.first_level + index);
    return MipLevel(level.first_line, ivec2(level.width, level.height));
}

// The level, with a fraction, whose texels are as large as the shorter side of a footprint: the derivatives of uv by
// pixel. Along the longer side the mean of samples filters.
float footprint_level(Image image, vec2 dx, vec2 dy) {
    vec2 size = vec2(image.width, image.height);
    float footprint = min(length(dx * size), length(dy * size));
    return clamp(log2(max(footprint, 1e-6)), 0.0, float(image.levels - 1));
}

// A texel's values as they are stored, see `decoded`.
vec4 texel(Image image, MipLevel level, ivec2 texel) {
    int index = level.first + texel.y * level.size.x + texel.x, line = image.first_line + index / WIDTH;
    ivec3 at = ivec3(index % WIDTH, line % LAYER_LINES, line / LAYER_LINES);
    vec4 stored = vec4(0.0);
#if HAS_BYTE_TEXELS
    if (image.encoding != FLOATS) stored = texelFetch(byte_texels, at, 0);
#endif
#if HAS_FLOAT_TEXELS
    if (image.encoding == FLOATS) stored = texelFetch(float_texels, at, 0);
#endif
    return stored;
}

// Linear values. Cycles decodes after it has interpolated.
vec4 decoded(Image image, vec4 stored) {
    vec3 linear = stored.rgb * image.scale;
#if HAS_BYTE_TEXELS
    vec3 bright = pow((max(stored.rgb, 0.04045) + 0.055) / 1.055, vec3(2.4));
    vec3 of_srgb = mix(stored.rgb / 12.92, bright, greaterThan(stored.rgb, vec3(0.04045)));
    if (image.encoding == SRGB_BYTES) linear = of_srgb;
#endif
    return vec4(linear, stored.a);
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
    return decoded(image, mix(mix(colors[0], colors[1], f.x), mix(colors[2], colors[3], f.x), f.y));
}

// dx, dy: derivatives of uv by pixel.
vec4 image_color(Image image, vec2 uv, vec2 dx, vec2 dy, int extension) {
    float level = footprint_level(image, dx, dy);
    MipLevel fine = mip_level(image, int(level));
    vec4 color = bilinear(image, fine, uv, extension);
    return level < float(image.levels - 1) ? mix(color, bilinear(image, halved(fine), uv, extension), fract(level))
                                           : color;
}
