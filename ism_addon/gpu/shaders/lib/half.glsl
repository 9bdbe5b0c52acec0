// The full-resolution pixel that a half-resolution one stands for.
ivec2 full_from_half(ivec2 at, ivec2 full_size) { return min(2 * at, full_size - 1); }
