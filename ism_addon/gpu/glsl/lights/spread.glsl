// What a spread below 180 degrees leaves of a light, see radiometry.py.
#include "lights/irradiance.glsl"
#include "closed_forms/spread_irradiance.glsl"

// Of the radiance towards a receiver so high over the light's plane, whose foot is so far from where it comes from.
float spread_falloff(Light light, float height, float away) {
    if (light.spread_scale == 0.0) return 1.0;
    return max(light.spread_tangent - away / max(height, 1e-30), 0.0) * light.spread_scale;
}

// Of a light seen as small, in units of the receiver's height: the mean at four points, of the third degree on its
// shape, each weighed by what it would send without a spread.
float small_spread(Light light, vec2 centre, vec2 u, vec2 v, vec3 n, int points) {
    float offset = light.shape == 0 ? 0.28867513459 : 0.25, sent = 0.0, left = 0.0;
    for (int k = 0; k < points; ++k) {
        vec2 at = centre + offset * ((k & 1) == 0 ? u : -u) + offset * ((k & 2) == 0 ? v : -v);
        float square = 1.0 + dot(at, at), weight = max(n.z + dot(n.xy, at), 1e-9) / (square * square);
        sent += weight;
        left += weight * max(light.spread_tangent - length(at), 0.0);
    }
    return light.spread_scale * left / max(sent, 1e-30);
}

// Irradiance of a receiver by a light of radiance 1 that nothing hides.
float light_irradiance(Light light, vec3 p, vec3 n) {
    vec3 centre = light.position - p;
    float full = area_irradiance(light, p, n), height = -dot(light.normal, centre), reach = light.spread_tangent;
    if (SPREADS == 0 || light.spread_scale == 0.0 || full == 0.0) return full;
    mat2x3 plane = mat2x3(light.tangent, cross(light.tangent, light.normal));
    vec2 to = (centre * plane) / height, u = (light.axis_u * plane) / height, v = (light.axis_v * plane) / height;
    vec3 turned = vec3(n * plane, -dot(n, light.normal));
    float size = max(dot(u, u), dot(v, v)), beyond = length(to) - reach;
    if (beyond > 0.0 && beyond * beyond > 0.5 * (dot(u, u) + dot(v, v))) return 0.0;
    bool small = size < 2.5e-3 * min(1.0 + dot(to, to), reach * reach);
    float part = small_spread(light, to, u, v, turned, small ? 4 : 0), sent;
    if (u.x * v.y < u.y * v.x) v = -v;
    if (is_rectangle(light)) sent = spread_polygon(to, u, v, turned, reach, small ? 0 : 5);
    else sent = spread_ellipse(to, 0.5 * u, 0.5 * v, turned, reach, small ? 0 : 12);
    return small ? full * part : max(sent, 0.0) * light.spread_scale;
}
