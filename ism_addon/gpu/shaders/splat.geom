// A point becomes the square of the map that its disc can touch.
#include "lib/octahedron.glsl"
layout(points) in;
layout(triangle_strip, max_vertices = 4) out;
uniform int side;
in vec3 point_centre[];
in vec3 point_normal[];
in float point_radius[];
flat out vec3 centre;
flat out vec3 normal;
flat out float radius;

// How far the map's coordinate can move, at most, when a direction moves by a unit of angle. Two octants meet where
// x or y is 0: there the steeper one counts.
float stretch(vec3 d, float angle) {
    vec3 a = abs(d);
    vec2 q = (d.xy * mat2(1.0, 1.0, 1.0, -1.0)) / (a.x + a.y + a.z);
    float steepest = 0.0;
    for (int k = 0; k < 4; ++k) {
        vec2 flip = vec2((k & 1) == 0 ? 1.0 : -1.0, (k & 2) == 0 ? 1.0 : -1.0);
        if (any(lessThan(flip * d.xy, vec2(-angle)))) continue;
        vec3 sides = vec3(flip, 1.0);
        vec3 u = vec3(1.0, 1.0, 0.0) - q.x * sides, v = vec3(1.0, -1.0, 0.0) - q.y * sides;
        steepest = max(steepest, max(dot(u, u), dot(v, v)));
    }
    return sqrt(steepest) / (a.x + a.y + a.z);
}

void main() {
    vec3 c = point_centre[0];
    float r = point_radius[0], distance = length(c);
    if (c.z <= -r || distance <= 1e-6 * r) return; // below the horizon, or the light point itself
    float angle = r / distance;
    vec2 middle = vec2(0.0), reach = vec2(2.0);
    if (angle < 0.5) {
        vec3 d = normalize(vec3(c.xy, max(c.z, 0.0)));
        middle = square_from_hemisphere(d);
        // The second term is what the map bends within the disc, the third half a texel's diagonal.
        reach = vec2(stretch(d, angle) * angle * (1.0 + 2.0 * angle) + 1.0 / float(side));
    }
    vec2 low = max(middle - reach, -1.0), high = min(middle + reach, 1.0);
    for (int k = 0; k < 4; ++k) {
        centre = c;
        normal = point_normal[0];
        radius = r;
        gl_Position = vec4((k & 1) == 0 ? low.x : high.x, (k & 2) == 0 ? low.y : high.y, 0.0, 1.0);
        EmitVertex();
    }
    EndPrimitive();
}
