// The triangle of a pixel in this sample, from the visibility buffer's finer grid.
uniform usampler2D visibility_buffer;
uniform mat2 fine_from_pixel;
uniform vec2 first; // fine pixel of the first pixel
uniform ivec2 last; // last fine pixel
flat in vec4 visibility_texel_and_offset;

// The index of the triangle plus 1, and that of the instance; 0 is the background. `pixel`: its lower left corner.
uvec2 visible_triangle(vec2 pixel) {
    ivec2 fine_pixel = ivec2(fine_from_pixel * pixel + first + visibility_texel_and_offset.xy + 0.5);
    return fetch(visibility_buffer, clamp(fine_pixel, ivec2(0), last)).xy;
}
