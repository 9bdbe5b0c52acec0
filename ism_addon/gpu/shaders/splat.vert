// A surface point in the space of the light point's map: z along the light's normal. m
uniform sampler2D light_points;
uniform int light_point;
in vec3 position;
in vec3 normal;
in float radius;
out vec3 point_centre;
out vec3 point_normal;
out float point_radius;

void main() {
    LightPoint light = fetch_LightPoint(light_points, light_point);
    mat3 map_from_anchor = transpose(mat3(light.tangent, cross(light.normal, light.tangent), light.normal));
    point_centre = map_from_anchor * (position - light.position);
    point_normal = map_from_anchor * normal;
    point_radius = radius;
    gl_Position = vec4(0.0, 0.0, 0.0, 1.0);
}
