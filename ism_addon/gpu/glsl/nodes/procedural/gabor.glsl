// The node Gabor Texture: waves of random phase within bells, which are spread over a grid, as in Cycles. The sum is a
// complex number (Lagae et al. 2009, Tavernier et al. 2019, Tricard et al. 2019).
#include "nodes/procedural/hash.glsl"
#include "nodes/procedural/texture_point.glsl"
#include "nodes/vectors.glsl"

const int WAVES_PER_CELL = 8, HASHES_PER_WAVE = 3;
const float GABOR_PI = 3.141592653589793;
// Standard deviations of 2D and 3D by the second moment of weights and the integral of the squared wave.
const float SECOND_MOMENT = 0.5, SQUARED_WAVE = 0.25;
const float DEVIATION_2D = sqrt(float(WAVES_PER_CELL) * SECOND_MOMENT * SQUARED_WAVE);
const float DEVIATION_3D = DEVIATION_2D / sqrt(sqrt(2.0));
// What is brought to a range of 1.
const float DEVIATIONS = 6.0;
const float MIN_FREQUENCY = 0.001;

vec2 polar(float radius, float angle) { return radius * vec2(cos(angle), sin(angle)); }

// The direction of a wave: of 2D, `orientation` is an angle, of 3D, a unit vector.
vec3 wave_direction_2d(vec3 orientation, float isotropy, vec4 seed) {
    return vec3(polar(1.0, orientation.x + (hash_number(seed, 3) - 0.5) * GABOR_PI * isotropy), 0.0);
}

vec3 wave_direction_3d(vec3 orientation, float isotropy, vec4 seed) {
    if (isotropy == 0.0) return orientation;
    // atan() of two zeros is not defined.
    float azimuth = orientation.xy == vec2(0.0) ? 0.0 : atan(orientation.y, orientation.x);
    float inclination = acos(clamp(orientation.z, -1.0, 1.0));
    inclination += hash_number(seed, 4) * GABOR_PI * isotropy;
    azimuth += hash_number(seed.zxwy, 4) * GABOR_PI * isotropy;
    return vec3(polar(sin(inclination), azimuth), cos(inclination));
}

vec2 waves_of_cell(vec3 cell, vec3 p, float frequency, float isotropy, vec3 orientation, int dimensions) {
    vec2 sum = vec2(0.0);
    for (int i = 0; i < WAVES_PER_CELL; ++i) {
        float first = float(HASHES_PER_WAVE * i);
        bool is_2d = dimensions == 2;
        vec4 seeds[HASHES_PER_WAVE];
        for (int k = 0; k < HASHES_PER_WAVE; ++k)
            seeds[k] = is_2d ? vec4(cell.xy, first + float(k), 0.0) : vec4(cell, first + float(k));
        vec3 centre = is_2d ? vec3(hash_number(seeds[1], 3), hash_number(vec4(seeds[1].zxy, 0.0), 3), 0.0)
                            : hash_color(seeds[1], 4);
        vec3 d = p - centre;
        float square = dot(d, d);
        if (square >= 1.0) continue;
        vec3 direction = is_2d ? wave_direction_2d(orientation, isotropy, seeds[0])
                               : wave_direction_3d(orientation, isotropy, seeds[0]);
        float weight = hash_number(seeds[2], dimensions + 1) < 0.5 ? -1.0 : 1.0;
        float bell = exp(-GABOR_PI * square) * (0.5 + 0.5 * cos(GABOR_PI * square));
        sum += polar(weight * bell, 2.0 * GABOR_PI * frequency * dot(d, direction));
    }
    return sum;
}

// Value, phase and intensity.
vec3 gabor(vec4 p, float frequency, float anisotropy, vec3 orientation, int dimensions) {
    vec3 corner = floor(p.xyz), inside = p.xyz - corner;
    float isotropy = 1.0 - clamp(anisotropy, 0.0, 1.0);
    vec2 sum = vec2(0.0);
    for (int z = dimensions > 2 ? -1 : 0; z <= (dimensions > 2 ? 1 : 0); ++z)
        for (int y = -1; y <= 1; ++y)
            for (int x = -1; x <= 1; ++x) {
                vec3 offset = vec3(x, y, z);
                sum += waves_of_cell(corner + offset, inside - offset, max(frequency, MIN_FREQUENCY), isotropy,
                                     orientation, dimensions);
            }
    float range = DEVIATIONS * (dimensions == 2 ? DEVIATION_2D : DEVIATION_3D);
    float phase = sum == vec2(0.0) ? 0.0 : atan(sum.y, sum.x);
    return vec3(0.5 * sum.y / range + 0.5, (phase + GABOR_PI) / (2.0 * GABOR_PI), length(sum) / range);
}

vec3 gabor_2d(vec4 p, float frequency, float anisotropy, float orientation) {
    return gabor(p, frequency, anisotropy, vec3(orientation), 2);
}

vec3 gabor_3d(vec4 p, float frequency, float anisotropy, vec3 orientation) {
    return gabor(p, frequency, anisotropy, vector_normalize(orientation), 3);
}
