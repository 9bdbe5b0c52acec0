// What a spread below 180 degrees leaves of the radiance, see radiometry.py. `c`: cosine of the angle off the normal.
float spread(Light light, float c) {
    if (light.spread_scale == 0.0) return 1.0;
    float tangent = sqrt(max(1.0 - c * c, 0.0)) / max(c, 1e-20);
    return max(light.spread_tangent - tangent, 0.0) * light.spread_scale;
}
