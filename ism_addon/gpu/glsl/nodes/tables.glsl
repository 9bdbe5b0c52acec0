// Operations with tables: ramps and curves. See shading/colors.py. A table's rows are among the material's constants.
#include "nodes/point.glsl"

const int LAST_ROW = 255;

vec4 color_ramp(int table, float position) {
    float inside = clamp(position, 0.0, 1.0) * float(LAST_ROW);
    int row = min(int(inside), LAST_ROW - 1);
    vec4 one = graph_constant(table + row), other = graph_constant(table + row + 1);
    return mix(one, other, inside - float(row));
}

vec4 color_ramp_constant(int table, float position) {
    return graph_constant(table + int(clamp(position, 0.0, 1.0) * float(LAST_ROW)));
}

vec4 extrapolated(int table, float position) {
    int end = position < 0.0 ? 0 : LAST_ROW - 1;
    vec4 slope = graph_constant(table + end + 1) - graph_constant(table + end);
    return color_ramp(table, position) + slope * ((position - clamp(position, 0.0, 1.0)) * float(LAST_ROW));
}

vec3 rgb_curves(int table, float low, float high, float t, vec3 color) {
    vec3 at = (color - low) / (high - low);
    return mix(color, vec3(color_ramp(table, at.x).x, color_ramp(table, at.y).y, color_ramp(table, at.z).z), t);
}

vec3 rgb_curves_extrapolated(int table, float low, float high, float t, vec3 color) {
    vec3 at = (color - low) / (high - low);
    return mix(color, vec3(extrapolated(table, at.x).x, extrapolated(table, at.y).y, extrapolated(table, at.z).z), t);
}
