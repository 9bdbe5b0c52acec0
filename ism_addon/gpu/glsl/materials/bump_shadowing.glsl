// The fraction of light from wi that a diffuse surface keeps if bumps turn its normal from `smooth_normal` to n.
// BUMPS 1, as in Cycles before 4.5: where bumps brighten it, a cubic of the ratio of both cosines, which falls to 0 at the
// horizon (Chiang, Li & Burley 2019). BUMPS 2: as if microfacets of that slope shadowed each other (Estevez, Lecocq &
// Stein 2019).
float bump_shadowing(vec3 n, vec3 smooth_normal, vec3 wi) {
    float turned = max(dot(n, smooth_normal), 1e-3), height = dot(smooth_normal, wi);
    if (height <= 0.0) return 0.0;
#if BUMPS == 1
    float ratio = min(height / max(dot(n, wi) * turned, 1e-6), 1.0);
    return ratio * (1.0 + ratio - ratio * ratio);
#else
    float alpha_square = clamp(0.125 * (1.0 / (turned * turned) - 1.0), 0.0, 1.0);
    float slope_square = max(1.0 / (height * height) - 1.0, 0.0);
    return 2.0 / (1.0 + sqrt(1.0 + alpha_square * slope_square));
#endif
}
