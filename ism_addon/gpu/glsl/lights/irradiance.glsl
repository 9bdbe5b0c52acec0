// Irradiance of a receiver by a light of radiance 1 that nothing hides, its spread left out, see radiometry.py.
// A pass whose lights are none of a kind may say so when it compiles this: many drivers run both sides of an `if`.
#ifndef RECTANGLES
#define RECTANGLES 1
#endif
#ifndef ELLIPSES
#define ELLIPSES 1
#endif
#ifndef SPREADS
#define SPREADS 1
#endif
#include "closed_forms/polygon.glsl"
#include "closed_forms/ellipse.glsl"

bool is_rectangle(Light light) { return ELLIPSES == 0 || (RECTANGLES == 1 && light.shape == 0); }

float area_irradiance(Light light, vec3 p, vec3 n) {
    vec3 centre = light.position - p, u = light.axis_u, v = light.axis_v;
    if (dot(light.normal, centre) >= 0.0) return 0.0;
    float scale = inversesqrt(max(dot(centre, centre), max(dot(u, u), dot(v, v)))); // no power of it overflows
    centre *= scale;
    u *= scale;
    v *= scale;
    if (is_rectangle(light)) return polygon_irradiance(centre, u, v, n, light.normal);
    return ellipse_irradiance(centre, 0.5 * u, 0.5 * v, n, light.normal);
}
