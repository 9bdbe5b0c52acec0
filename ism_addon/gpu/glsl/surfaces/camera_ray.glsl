// Camera rays, see gl/frame_uniforms.py.
struct Ray { vec3 origin; vec3 direction; };

Ray view_ray(vec2 pixel) {
    return Ray(ray_origin.xyz + pixel.x * ray_origin_x.xyz + pixel.y * ray_origin_y.xyz,
               ray_direction.xyz + pixel.x * ray_direction_x.xyz + pixel.y * ray_direction_y.xyz);
}
