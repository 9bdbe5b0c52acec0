// The correction of a predicted visibility by a ray to `point`. `estimate`: of `unshadowed`; both are radiance.
// If the unshadowed light is exact, a ray that finds what was predicted corrects nothing, so it adds no noise. If it is
// exact but for falloff, such a ray corrects only the difference of falloff. An interpolated one may not be reliable.
vec3 ray_correction(vec3 estimate, vec3 visible, vec3 unshadowed, float predicted, Light light, vec3 p, vec3 point,
                    bool is_reliable) {
#if EXACT_BUT_FOR_FALLOFF
    if (is_reliable) return estimate * (visible - predicted * light_falloff_ratio(light, p, point));
#endif
    return estimate * visible - unshadowed * predicted;
}
