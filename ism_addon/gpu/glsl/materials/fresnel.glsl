// Fresnel's equations and the approximations to them that Cycles uses.

// Reflectance of a smooth dielectric of the relative index of refraction eta, for unpolarized light at this cosine.
float fresnel_dielectric(float cosine, float eta) {
    float square = eta * eta - 1.0 + cosine * cosine;
    if (square <= 0.0) return 1.0; // total internal reflection
    float g = sqrt(square), a = (g - cosine) / (g + cosine), b = (cosine * (g + cosine) - 1.0) / (cosine * (g - cosine) + 1.0);
    return 0.5 * a * a * (1.0 + b * b);
}

// The same at normal incidence.
float dielectric_f0(float eta) {
    float root = (eta - 1.0) / (eta + 1.0);
    return root * root;
}

// How far the reflectance of a dielectric has risen from that at normal incidence, to 1 at grazing angles.
float dielectric_rise(float cosine, float eta) {
    float f0 = dielectric_f0(eta);
    return clamp((fresnel_dielectric(cosine, eta) - f0) / max(1.0 - f0, 1e-6), 0.0, 1.0);
}

// The same by the approximation of Schlick 1994, for all materials.
float schlick_rise(float cosine) {
    float x = clamp(1.0 - cosine, 0.0, 1.0), square = x * x;
    return square * square * x;
}

// The change of a metal's reflectance at angles around 82 degrees, for a coefficient of 1 (Kutz, Hasan & Edmondson 2021).
float edge_change(float cosine) {
    float x = clamp(1.0 - cosine, 0.0, 1.0), cube = x * x * x;
    return cosine * cube * cube;
}
