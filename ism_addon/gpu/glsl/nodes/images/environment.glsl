// The node Environment Texture: images of all directions, as in Cycles.
#include "nodes/images/image.glsl"

vec3 equirectangular_uv(vec3 d) {
    float longitude = d.xy == vec2(0.0) ? 0.0 : atan(d.y, d.x);
    return vec3(0.5 - 0.5 * longitude / HALF_CIRCLE, 1.0 - acos(clamp(d.z / length(d), -1.0, 1.0)) / HALF_CIRCLE, 0.0);
}

vec3 mirror_ball_uv(vec3 d) {
    d.y -= 1.0;
    float divisor = 2.0 * sqrt(max(-0.5 * d.y, 0.0));
    return vec3(0.5 * (divisor > 0.0 ? d.xz / divisor : d.xz) + 0.5, 0.0);
}

vec4 image_equirectangular(float image, vec3 d, vec3 dx, vec3 dy, int sampling) {
    vec3 uv = equirectangular_uv(d);
    return image_interpolated(image, uv, around(equirectangular_uv(d + dx) - uv), around(equirectangular_uv(d + dy) - uv),
                              sampling);
}

vec4 image_mirror_ball(float image, vec3 d, vec3 dx, vec3 dy, int sampling) {
    vec3 uv = mirror_ball_uv(d);
    return image_interpolated(image, uv, mirror_ball_uv(d + dx) - uv, mirror_ball_uv(d + dy) - uv, sampling);
}
