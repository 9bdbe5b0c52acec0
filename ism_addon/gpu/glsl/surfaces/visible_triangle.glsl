// The triangle of a pixel in this sample, from the visibility buffer's finer grid.
#include "textures/fine_pixel.glsl"
uniform usampler2D visibility_buffer;
flat in vec4 visibility_texel_and_offset;

// The index of the triangle plus 1, and that of the instance; 0 is the background. `pixel`: its lower left corner.
uvec2 visible_triangle(vec2 pixel) {
    return fetch(visibility_buffer, fine_pixel(pixel, visibility_texel_and_offset.xy)).xy;
}
