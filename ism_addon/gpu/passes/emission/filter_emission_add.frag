// Adds emission at a position of each pixel, by blending, to the pixels whose filters cover it.
#include "textures/pixel_filter.glsl"
uniform sampler2D subsample_emission;
flat in vec4 visibility_texel_and_offset;
layout(location = 0) out vec4 filtered_emission;

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    vec2 texel = texel_size(subsample_emission);
    filtered_emission = vec4(0.0);
    for (int y = -MARGIN; y <= MARGIN; ++y) {
        for (int x = -MARGIN; x <= MARGIN; ++x) {
            vec2 offset = vec2(x, y) + visibility_texel_and_offset.zw;
            float weight = filter_weight(offset.x) * filter_weight(offset.y);
            filtered_emission += weight * vec4(fetch(subsample_emission, at + ivec2(x, y) + MARGIN, texel).rgb, 1.0);
        }
    }
}
