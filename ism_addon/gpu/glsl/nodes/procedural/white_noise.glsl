// The node White Noise.
#include "nodes/procedural/hash.glsl"
#include "nodes/procedural/texture_point.glsl"

float white_noise(vec4 p, int dimensions) { return hash_number(p, dimensions); }
vec3 white_noise_color(vec4 p, int dimensions) { return hash_color(p, dimensions); }
