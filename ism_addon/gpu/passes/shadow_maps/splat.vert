// Turns a surface point into a square of the map that contains its disc. Map space: z along the virtual light's axis, m.
#include "maths/octahedron.glsl"
uniform vec3 origin;
uniform mat3 map_from_anchor;
uniform float map_radius; // m: half of the width of a parallel map
uniform int side;
in vec3 position;
in vec3 normal;
in float radius;
flat out vec3 disc_centre;
flat out vec3 disc_normal;
flat out float disc_radius;

// The largest derivative of the map's coordinates by the angle of a direction d. It is discontinuous between octants,
// where x or y is 0: within `angle` of there the larger value of both sides is used.
float largest_derivative(vec3 d, float angle) {
    float sum = abs(d.x) + abs(d.y) + abs(d.z);
    vec2 q = vec2(d.x + d.y, d.x - d.y) / sum; // square_from_hemisphere
    bvec2 spans_octants = lessThan(abs(d.xy), vec2(angle));
    vec2 signs = vec2(d.x < 0.0 ? -1.0 : 1.0, d.y < 0.0 ? -1.0 : 1.0);
    vec2 u = mix(1.0 - q.x * signs, 1.0 + abs(q.xx), spans_octants);
    vec2 v = mix(1.0 + q.y * vec2(-signs.x, signs.y), 1.0 + abs(q.yy), spans_octants);
    return sqrt(max(dot(u, u) + q.x * q.x, dot(v, v) + q.y * q.y)) / sum;
}

void main() {
    vec3 c = map_from_anchor * (position - origin);
    disc_centre = c;
    disc_normal = map_from_anchor * normal;
    disc_radius = radius;
#if PARALLEL
    gl_Position = vec4(c.xy / map_radius, 0.0, 1.0);
    gl_PointSize = radius / map_radius * float(side) + 1.0;
#else
    float distance = length(c), angle = radius / distance;
    float top = c.z + radius * sqrt(max(1.0 - disc_normal.z * disc_normal.z, 0.0)); // the disc's highest point
    gl_Position = vec4(0.0, 0.0, 0.0, 1.0);
    gl_PointSize = 2.0 * float(side);
    if (top <= 0.0 || distance <= 1e-6 * radius) { // below the horizon, or at the virtual light
        gl_Position.x = 2.0; // outside the map
        gl_PointSize = 1.0; // some drivers draw what reaches into the map of a point whose centre is outside
    } else if (angle < 0.5) {
        vec3 d = normalize(vec3(c.xy, max(c.z, 0.0)));
        gl_Position.xy = clamp(square_from_hemisphere(d), -1.0, 1.0); // OpenGL drops points whose centre is outside
        // The second term bounds how much the derivative changes within the disc.
        gl_PointSize = largest_derivative(d, angle) * angle * (1.0 + 2.0 * angle) * float(side) + 1.0;
    }
#endif
}
