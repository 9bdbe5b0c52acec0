// atan(sine, cosine) for sine >= 0, with an error below 1e-7. GLSL's atan has an error of up to 2e-5 on some drivers.
// A minimax fit of atan(x)/x in x^2 on [0, 1].
float atan2_accurate(float sine, float cosine) {
    float size = abs(cosine), x = min(sine, size) / max(max(sine, size), 1e-30), s = x * x;
    float angle = -0.00469326 * s + 0.02425234;
    angle = (angle * s - 0.05948632) * s + 0.09914289;
    angle = (angle * s - 0.1401948) * s + 0.19969724;
    angle = ((angle * s - 0.33331991) * s + 0.9999999) * x;
    angle = sine > size ? 1.5707963267948966 - angle : angle;
    return cosine < 0.0 ? 3.141592653589793 - angle : angle;
}
