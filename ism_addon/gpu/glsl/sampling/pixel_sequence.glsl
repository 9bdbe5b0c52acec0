// A two-dimensional sequence over the pixels of a picture.
uniform uvec2 pixel_steps; // see sampling

// A pixel's index in a sequence over the picture, along a space-filling curve (Ahmed & Wonka 2020). Aligned tiles of 2,
// 4, 8 or 16 pixels have consecutive indices, so their rays together cover all of the light.
uint pixel_index(ivec2 at) {
    uvec2 bits = uvec2(at) & 1023u;
    bits = (bits | (bits << 8)) & 0x300ffu; // ten bits of each, interleaved
    bits = (bits | (bits << 4)) & 0xf0f0fu;
    bits = (bits | (bits << 2)) & 0x33333u;
    bits = (bits | (bits << 1)) & 0x55555u;
    return bits.x | (bits.y << 1);
}

// From 32-bit fixed point to [0,1). Sums in fixed point wrap around, and keep digits that float32 would round away.
vec2 unit_square(uvec2 fixed_point) { return vec2(fixed_point >> 8u) / 16777216.0; }

// The light_uv of a pixel, from that of the first pixel.
vec2 pixel_sequence(ivec2 at, uvec2 light_uv) { return unit_square(light_uv + pixel_index(at) * pixel_steps); }
