// Position in pixels, and clip-space w: positive in front of the camera.
vec3 project(vec3 p) {
    vec4 clip = clip_from_anchor * vec4(p, 1.0);
    return vec3((0.5 * clip.xy / clip.w + 0.5) * picture_size.xy, clip.w);
}
