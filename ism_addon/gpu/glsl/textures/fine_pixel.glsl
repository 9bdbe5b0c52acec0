// A pixel's sample in the visibility buffer's finer grid.
uniform mat2 fine_from_pixel;
uniform vec2 first; // fine pixel of the first pixel
uniform ivec2 last; // last fine pixel

// `pixel`: its lower left corner. `texel`: of its samples' texels, the one of this sample.
ivec2 fine_pixel(vec2 pixel, vec2 texel) {
    return clamp(ivec2(fine_from_pixel * pixel + first + texel + 0.5), ivec2(0), last);
}
