// The radius of ambient occlusion at a point, m: so many meters, or so many pixels.
uniform float radius_meters;
uniform float radius_pixels;

float occlusion_radius(vec3 p) {
    float depth = -(view_from_anchor * vec4(p, 1.0)).z;
    return radius_meters + radius_pixels * (length(ray_origin_x.xyz) + depth * length(ray_direction_x.xyz));
}
