// Where a texture of one to four dimensions is evaluated, and how many octaves it has. Components of the point beyond its
// dimensions are 0: so one function serves all numbers of dimensions. It has no cost, because that number is known when
// the shader is compiled.

// Limit of the octaves after the first.
const float MAX_DETAIL = 15.0;

bvec4 has_dimension(int dimensions) { return greaterThan(ivec4(dimensions), ivec4(0, 1, 2, 3)); }
vec4 within_dimensions(vec4 v, int dimensions) { return mix(vec4(0.0), v, has_dimension(dimensions)); }

vec4 texture_point(vec3 v, float w, float scale, int dimensions) {
    return within_dimensions(dimensions == 1 ? vec4(w) : vec4(v, w), dimensions) * scale;
}

// The number of octaves may have a fraction: the last one then has a share of less than 1.
float octave_count(float detail) { return clamp(detail, 0.0, MAX_DETAIL) + 1.0; }
float octave_share(float count, int octave) { return min(count - float(octave), 1.0); }
