// The full-resolution pixel that a half-resolution one stands for.
ivec2 full_from_half(ivec2 at) { return min(2 * at, last_pixel()); }
