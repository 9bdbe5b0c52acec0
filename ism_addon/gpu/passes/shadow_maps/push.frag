// Fills a finer texel that is a hole with the coarser level's depth, interpolated between four texels of the same map.
#include "textures/pull_push_level.glsl"
uniform sampler2D coarse;
uniform int coarse_side;
out vec2 texel;

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    texel = fine_texel(at);
    vec2 coarse_position = 0.5 * (vec2(at) + 0.5) - 0.5;
    ivec2 low = ivec2(floor(coarse_position));
    vec2 f = coarse_position - vec2(low);
    ivec2 first = (at / 2) / coarse_side * coarse_side;
    vec2 four[4];
    float nearest = EMPTY;
    for (int k = 0; k < 4; ++k) {
        ivec2 neighbour = clamp(low + ivec2(k & 1, k >> 1), first, first + coarse_side - 1);
        four[k] = fetch(coarse, neighbour).xy;
        if (four[k].y > 0.0) nearest = min(nearest, four[k].x);
    }
    float depth = 0.0, coverage = 0.0;
    for (int k = 0; k < 4; ++k) {
        if (four[k].y > 0.0 && four[k].x <= nearest * (1.0 + threshold)) {
            float weight = ((k & 1) == 0 ? 1.0 - f.x : f.x) * ((k >> 1) == 0 ? 1.0 - f.y : f.y) * four[k].y;
            depth += weight * four[k].x;
            coverage += weight;
        }
    }
    bool hole = texel.y <= 0.0 || texel.x > (depth / max(coverage, 1e-20)) * (1.0 + threshold);
    if (hole && coverage > 0.5) texel = vec2(depth / coverage, coverage);
}
