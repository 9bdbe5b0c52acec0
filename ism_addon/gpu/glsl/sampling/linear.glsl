// A number in [0,1) whose density is linear, between values at 0 and 1 that need no normalization (as in pbrt).
float sample_linear(vec2 ends, float u) {
    ends /= ends.x + ends.y; // so that no square underflows
    return u / (ends.x + sqrt(mix(ends.x * ends.x, ends.y * ends.y, u)));
}

float linear_pdf(vec2 ends, float u) { return 2.0 * mix(ends.x, ends.y, u) / (ends.x + ends.y); }
