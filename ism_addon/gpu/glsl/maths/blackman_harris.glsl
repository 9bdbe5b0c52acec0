// The pixel filter's weight x px from its middle, which reaches so many px (Harris 1978).
float blackman_harris(float x, float reach) {
    float c = cos(3.141592653589793 * (x / reach + 1.0));
    return abs(x) < reach ? 0.35875 - 0.48829 * c + 0.14128 * (2.0 * c * c - 1.0) - 0.01168 * c * (4.0 * c * c - 3.0) : 0.0;
}
