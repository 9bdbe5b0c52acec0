// Filtered look-up in an image whose texels, and those of its halved copies, lie one behind the other.
uniform sampler2D texels; // WIDTH to a line

struct Level { int first; ivec2 size; }; // one of the copies: its first texel

Level halved(Level level) { return Level(level.first + level.size.x * level.size.y, max(level.size >> 1, ivec2(1))); }

vec3 texel(Material image, Level level, int x, int y) {
    int number = level.first + y * level.size.x + x;
    return fetch(texels, ivec2(number % WIDTH, image.first_line + number / WIDTH)).rgb;
}

vec3 bilinear(Material image, Level level, vec2 uv) {
    bool repeat = image.repeat != 0;
    vec2 at = (repeat ? fract(uv) : clamp(uv, 0.0, 1.0)) * vec2(level.size) - 0.5, whole = floor(at), f = at - whole;
    ivec2 low = ivec2(whole), high = low + 1, last = level.size - 1; // beyond the border by one texel at most
    low = repeat ? low + level.size * ivec2(lessThan(low, ivec2(0))) : max(low, 0);
    high = repeat ? high * ivec2(lessThanEqual(high, last)) : min(high, last);
    return mix(mix(texel(image, level, low.x, low.y), texel(image, level, high.x, low.y), f.x),
               mix(texel(image, level, low.x, high.y), texel(image, level, high.x, high.y), f.x), f.y);
}

// dx, dy: how uv changes from pixel to pixel.
vec3 image_color(Material image, vec2 uv, vec2 dx, vec2 dy) {
    Level fine = Level(0, ivec2(image.width, image.height));
    // By the shorter side of the pixel's footprint: what it leaves unfiltered along the longer, the samples average.
    float footprint = min(length(dx * vec2(fine.size)), length(dy * vec2(fine.size)));
    float level = clamp(log2(max(footprint, 1e-6)), 0.0, float(image.levels - 1));
    for (int k = 1; k <= int(level); ++k) fine = halved(fine);
    vec3 color = bilinear(image, fine, uv);
    return level < float(image.levels - 1) ? mix(color, bilinear(image, halved(fine), uv), fract(level)) : color;
}
