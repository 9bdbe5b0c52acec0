// Filtered look-up in an image whose texels, and those of its halved copies, lie one behind the other.
uniform sampler2D texels; // WIDTH to a line

vec3 texel(Material image, int first, ivec2 size, ivec2 at) {
    at = image.repeat != 0 ? at - size * ivec2(floor(vec2(at) / vec2(size))) : clamp(at, ivec2(0), size - 1);
    int number = first + at.y * size.x + at.x;
    return fetch(texels, ivec2(number % WIDTH, image.first_line + number / WIDTH)).rgb;
}

vec3 bilinear(Material image, int level, vec2 uv) {
    ivec2 size = ivec2(image.width, image.height);
    int first = 0;
    for (int k = 0; k < level; ++k) {
        first += size.x * size.y;
        size = max(size / 2, ivec2(1));
    }
    vec2 at = (image.repeat != 0 ? fract(uv) : clamp(uv, 0.0, 1.0)) * vec2(size) - 0.5;
    ivec2 low = ivec2(floor(at));
    vec2 f = at - vec2(low);
    return mix(mix(texel(image, first, size, low), texel(image, first, size, low + ivec2(1, 0)), f.x),
               mix(texel(image, first, size, low + ivec2(0, 1)), texel(image, first, size, low + 1), f.x), f.y);
}

// dx, dy: how uv changes from pixel to pixel.
vec3 image_color(Material image, vec2 uv, vec2 dx, vec2 dy) {
    vec2 size = vec2(image.width, image.height);
    // By the shorter side of the pixel's footprint: what it leaves unfiltered along the longer, the samples average.
    float footprint = min(length(dx * size), length(dy * size));
    float level = clamp(log2(max(footprint, 1e-6)), 0.0, float(image.levels - 1));
    int fine = int(level);
    vec3 color = bilinear(image, fine, uv);
    return fine + 1 < image.levels ? mix(color, bilinear(image, fine + 1, uv), level - float(fine)) : color;
}
