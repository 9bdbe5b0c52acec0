// The triangle's index plus 1, and the instance's index. 0 is the background. With TRANSPARENCY, surfaces are drawn with
// the probability that they are opaque (Enderton et al. 2010): samples of a pixel are stratified for each triangle.
#include "surfaces/instance_fragment.glsl"
#if TRANSPARENCY
#include "maths/random_bits.glsl"
uniform mat2 pixel_from_fine;
uniform vec2 first;      // fine pixel of the first pixel
uniform uvec3 strata; // number of fine pixels in a pixel, a power of two; factor of y that numbers them; of the first
uniform uvec2 sample_digits; // by that number the index of the sample in the grid, four bits each
uniform uint round_seed; // other for each 16 samples
#endif
out uvec2 id;

#if TRANSPARENCY
// All permutations of 0 to 3: two bits for each digit, four permutations in a number.
const uint PERMUTATIONS[6] = uint[6](0x78d8b4e4u, 0xb1e16c9cu, 0x2d8d39c9u,
                                     0x36c672d2u, 0x63931e4eu, 0x1b4b2787u);

uint permuted(uint digit, uint random) {
    uint index = (random >> 8) % 24u;
    return PERMUTATIONS[index >> 2] >> (8u * (index & 3u) + 2u * digit) & 3u;
}

// Between 0 and 1, for a triangle in a fine pixel, independent of other triangles' numbers. Of a pixel's samples, each
// four are in different quarters, and each sixteen in different sixteenths.
float stratified_number(uvec2 id, vec2 fine_pixel) {
    vec2 fine = floor(fine_pixel) - first;
    uvec2 texel = uvec2(ivec2(fine)), pixel = uvec2(ivec2(floor(pixel_from_fine * fine + 0.5)));
    uvec3 seeds = random_bits(uvec3(id.x, id.y, pixel.x | pixel.y << 16), round_seed);
    uint number = texel.x + texel.y * strata.y & strata.x - 1u;
    uint index = strata.z + (sample_digits[number >> 3] >> 4u * (number & 7u) & 15u);
    uint group = index >> 2, jitter = random_bits(uvec3(index, seeds.yz), round_seed).x >> 8;
    uint quarter = permuted(index & 3u, seeds.x + 0x9e3779b9u * group);
    uint within = permuted(group, seeds.y + 0x9e3779b9u * quarter);
    return (float(4u * quarter + within) + float(jitter) / 16777216.0) / 16.0;
}
#endif

void main() {
#if TRANSPARENCY
    int material = material_of_triangle();
    if (has_transparency(material)) {
        float probability = pass_probability(passing(material));
        if (stratified_number(triangle_and_instance, gl_FragCoord.xy) < probability) discard;
    }
#endif
    id = triangle_and_instance;
    write_depth();
}
