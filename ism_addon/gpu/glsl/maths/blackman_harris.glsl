// The Blackman-Harris pixel filter (Harris 1978): weight at the distance x from its centre; px.
float blackman_harris(float x, float radius) {
    float c = cos(3.141592653589793 * (x / radius + 1.0));
    return abs(x) < radius
               ? 0.35875 - 0.48829 * c + 0.14128 * (2.0 * c * c - 1.0) - 0.01168 * c * (4.0 * c * c - 3.0)
               : 0.0;
}
