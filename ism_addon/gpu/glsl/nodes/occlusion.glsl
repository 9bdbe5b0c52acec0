// What the node Ambient Occlusion shows, as in Cycles: the fraction of rays about a normal that meet nothing.
#include "nodes/point.glsl"
#ifdef TRACES_NODES
#include "maths/orthonormal_basis.glsl"
#include "maths/rounding.glsl"
#include "sampling/cosine_hemisphere.glsl"
#include "sampling/pixel_sequence.glsl"
#include "sampling/sample_index.glsl"
#include "trace/traversal.glsl"
uniform uvec2 first_node_ray; // of the first pixel's first ray, in the sequence over the picture
uniform uvec2 node_ray_steps;

// `rays`: twice their number, and 1 more if they go inside. Without a distance, all surfaces count.
float ambient_occlusion(ShadingPoint at, float distance, vec3 normal, int rays) {
    float side = (rays & 1) == 1 ? -1.0 : 1.0, reach = distance > 0.0 ? distance : 2.0 * scene_extent.x;
    int count = rays >> 1;
    mat3 hemisphere = basis(side * normalize(normal));
    vec3 from = at.position + side * rounding(at.position) * at.geometric_normal;
    float open = 0.0;
    for (int k = 0; k < count; ++k) {
        uvec2 shift = first_node_ray + uint(int(sample_index) * count + k) * node_ray_steps;
        vec3 wi = hemisphere * cosine_hemisphere(pixel_sequence(ivec2(gl_FragCoord.xy), shift));
        open += transmittance(from, from + reach * wi, at.triangle, at.instance, CASTERS).x;
    }
    return open / float(count);
}
#else
float ambient_occlusion(ShadingPoint at, float distance, vec3 normal, int rays) { return 1.0; }
#endif
