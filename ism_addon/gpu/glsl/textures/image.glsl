// Filtered look-up in an image. The texels of its mip levels are stored one after another, WIDTH texels to a line.
// There is one texture for each encoding.
uniform sampler2D srgb_texels;
uniform sampler2D linear_texels;
uniform sampler2D float_texels;

struct MipLevel { int first; ivec2 size; }; // index of its first texel

MipLevel halved(MipLevel level) {
    return MipLevel(level.first + level.size.x * level.size.y, max(level.size >> 1, ivec2(1)));
}

vec3 texel(Material image, MipLevel level, int x, int y) {
    int index = level.first + y * level.size.x + x;
    ivec2 at = ivec2(index % WIDTH, image.first_line + index / WIDTH);
    vec3 color = vec3(0.0);
#if SRGB_IMAGES
    if (image.encoding == 0) color = fetch(srgb_texels, at).rgb;
#endif
#if LINEAR_IMAGES
    if (image.encoding == 1) color = fetch(linear_texels, at).rgb;
#endif
#if FLOAT_IMAGES
    if (image.encoding == 2) color = fetch(float_texels, at).rgb;
#endif
    return color;
}

vec3 bilinear(Material image, MipLevel level, vec2 uv) {
    bool repeat = image.repeat != 0;
    vec2 at = (repeat ? fract(uv) : clamp(uv, 0.0, 1.0)) * vec2(level.size) - 0.5, corner = floor(at), f = at - corner;
    ivec2 low = ivec2(corner), high = low + 1, last = level.size - 1; // outside the border by one texel at most
    low = repeat ? low + level.size * ivec2(lessThan(low, ivec2(0))) : max(low, 0);
    high = repeat ? high * ivec2(lessThanEqual(high, last)) : min(high, last);
    return mix(mix(texel(image, level, low.x, low.y), texel(image, level, high.x, low.y), f.x),
               mix(texel(image, level, low.x, high.y), texel(image, level, high.x, high.y), f.x), f.y);
}

// dx, dy: derivatives of uv by pixel.
vec3 image_color(Material image, vec2 uv, vec2 dx, vec2 dy) {
    MipLevel fine = MipLevel(0, ivec2(image.width, image.height));
    // Filtered by the shorter side of the pixel's footprint. Along the longer side the mean of samples filters.
    float footprint = min(length(dx * vec2(fine.size)), length(dy * vec2(fine.size)));
    float level = clamp(log2(max(footprint, 1e-6)), 0.0, float(image.levels - 1));
    for (int k = 1; k <= int(level); ++k) fine = halved(fine);
    vec3 color = bilinear(image, fine, uv);
    return level < float(image.levels - 1) ? mix(color, bilinear(image, halved(fine), uv), fract(level)) : color;
}
