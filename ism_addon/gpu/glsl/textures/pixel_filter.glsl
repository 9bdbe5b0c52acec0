// The weight of a sample along one axis. Without a margin the samples are distributed according to the filter.
#include "maths/blackman_harris.glsl"
uniform float filter_radius; // px

float filter_weight(float x) { return MARGIN == 0 ? 1.0 : blackman_harris(x, filter_radius); }
