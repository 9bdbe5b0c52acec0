// Camera rays, see gl/frame_uniforms.py.
struct Ray { vec3 origin; vec3 direction; };

Ray view_ray(vec2 pixel) {
    return Ray(ray_origin.xyz + pixel.x * ray_origin_x.xyz + pixel.y * ray_origin_y.xyz,
               ray_direction.xyz + pixel.x * ray_direction_x.xyz + pixel.y * ray_direction_y.xyz);
}

// From a point that the camera sees towards the camera. Rays of a perspective camera begin at one point.
vec3 direction_to_camera(vec3 p) {
    bool is_perspective = ray_origin_x.xyz == vec3(0.0) && ray_origin_y.xyz == vec3(0.0);
    return is_perspective ? normalize(ray_origin.xyz - p) : -normalize(ray_direction.xyz);
}
