// The full-resolution pixel that a half-resolution pixel samples.
ivec2 full_from_half(ivec2 at) { return min(2 * at, last_pixel()); }
