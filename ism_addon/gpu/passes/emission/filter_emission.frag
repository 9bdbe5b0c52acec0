// Emission that the camera sees at a position of each pixel, by a camera ray. Filters also cover pixels around the
// picture.
#include "trace/traversal.glsl"
#include "surfaces/emission.glsl"
#if TRANSPARENCY
#include "surfaces/shading_point.glsl"
#endif
uniform vec2 depths; // at which camera rays start and end, m
flat in vec4 visibility_texel_and_offset;
layout(location = 0) out vec4 subsample_emission;

vec3 point_at(Ray ray, float depth) { return ray.origin + depth * ray.direction; }

#if TRANSPARENCY
// Along a ray. What its surfaces let pass weights all that is behind them.
vec3 emission_through_surfaces(Ray ray) {
    vec3 sum = vec3(0.0), passed = vec3(1.0), incoming = -normalize(ray.direction);
    float start = depths.x;
    int triangle = -1, instance = -1;
    for (int k = 0; k <= transparent_hits && passed != vec3(0.0); ++k) {
        Intersection hit = nearest_hit(point_at(ray, start), point_at(ray, depths.y), triangle, instance);
        triangle = hit.triangle;
        instance = hit.instance;
        float depth = mix(start, depths.y, hit.distance);
        sum += passed * seen_radiance(ray, k == 0 ? 0.0 : start * length(ray.direction),
                                      triangle < 0 ? FAR : depth * length(ray.direction), NO_TINT);
        if (triangle < 0) break;
        int material = fetch_triangle(triangle).material;
        vec3 p = point_at(ray, depth);
        vec4 passes = vec4(0.0);
        if (has_transparency(material))
            passes = transparency(material, shading_point(triangle, instance, p, incoming));
#if EMISSIVE
        sum += passed * (1.0 - pass_probability(passes)) * surface_radiance(triangle, instance, p, incoming);
#endif
        passed *= passes.rgb;
        start = depth;
    }
    return sum;
}
#endif

void main() {
    Ray ray = view_ray(gl_FragCoord.xy - float(BORDER) + visibility_texel_and_offset.zw);
#if TRANSPARENCY
    subsample_emission = vec4(emission_through_surfaces(ray), 0.0);
#else
    Intersection hit = nearest_hit(point_at(ray, depths.x), point_at(ray, depths.y), -1, -1);
    float depth = mix(depths.x, depths.y, hit.distance);
    subsample_emission = vec4(emission_along(ray, depth, hit.triangle, hit.instance, NO_TINT), 0.0);
#endif
}
