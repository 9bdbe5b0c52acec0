// Operations of nodes that give what is known of a direction of the world: at.position is that, and at.barycentric its
// place in the picture.
#include "nodes/point.glsl"

vec3 world_direction(ShadingPoint at) { return normalize(at.position); }
vec3 world_window(ShadingPoint at) { return vec3(at.barycentric.xy, 0.0); }
