// The node Noise Texture: sums and products of octaves of Perlin's noise, as in Cycles. See shading/textures.py.
#include "nodes/procedural/hash.glsl"
#include "nodes/procedural/texture_point.glsl"

// They bring noise of one to four dimensions to about -1 ... 1.
const float NOISE_SCALES[4] = float[4](0.25, 0.6616, 0.982, 0.8344);
// Noise repeats after this distance.
const float NOISE_PERIOD = 100000.0;
// From here on float32 has too few digits after the point, and noise is 0 at whole numbers.
const float COARSE_POSITION = 1000000.0;
// Noise is independent of noise this far away.
const float NEAREST_OFFSET = 100.0, OFFSET_RANGE = 100.0;
// Below this weight, hybrid multifractal noise has no further octaves.
const float MIN_OCTAVE_WEIGHT = 0.001;

float negated_if(float a, uint bit) { return bit != 0u ? -a : a; }

// Of the gradient that a hash chooses, with a distance.
float gradient_product(uint hash, vec4 d, int dimensions) {
    if (dimensions == 1) return negated_if(d.x * float(1u + (hash & 7u)), hash & 8u);
    uint h = hash & (dimensions == 2 ? 7u : dimensions == 3 ? 15u : 31u);
    float u, v, w = 0.0;
    if (dimensions == 2) {
        u = h < 4u ? d.x : d.y;
        v = h < 4u ? 2.0 * d.y : 2.0 * d.x;
    } else if (dimensions == 3) {
        u = h < 8u ? d.x : d.y;
        v = h < 4u ? d.y : h == 12u || h == 14u ? d.x : d.z;
    } else {
        u = h < 24u ? d.x : d.y;
        v = h < 16u ? d.y : d.z;
        w = h < 8u ? d.z : d.w;
    }
    return negated_if(u, h & 1u) + negated_if(v, h & 2u) + negated_if(w, h & 4u);
}

float perlin_noise(vec4 p, int dimensions) {
    p += 0.5 * step(COARSE_POSITION, abs(p)) - NOISE_PERIOD * trunc(p / NOISE_PERIOD);
    vec4 cell = floor(p), inside = p - cell;
    vec4 t = inside * inside * inside * (inside * (inside * 6.0 - 15.0) + 10.0);
    float sum = 0.0;
    for (int corner = 0; corner < 1 << dimensions; ++corner) {
        ivec4 side = ivec4(corner, corner >> 1, corner >> 2, corner >> 3) & 1;
        vec4 w = mix(1.0 - t, t, equal(side, ivec4(1)));
        uint hash = jenkins_hash(uvec4(ivec4(cell) + side), dimensions);
        sum += w.x * w.y * w.z * w.w * gradient_product(hash, inside - vec4(side), dimensions);
    }
    return NOISE_SCALES[dimensions - 1] * sum;
}

vec4 noise_offset(int seed, int dimensions) {
    vec4 offset = vec4(0.0);
    for (int k = 0; k < dimensions; ++k)
        offset[k] = NEAREST_OFFSET + OFFSET_RANGE * hash_number(vec4(seed, k, 0.0, 0.0), min(dimensions, 2));
    return offset;
}

vec4 noise_distorted(vec4 p, float distortion, int dimensions) {
    vec4 noise = vec4(0.0);
    for (int k = 0; k < dimensions; ++k) noise[k] = perlin_noise(p + noise_offset(k, dimensions), dimensions);
    return p + distortion * noise;
}

// What the octaves up to one have made.
struct Octaves {
    float value;
    float sum;
    float amplitude;
    float weight; // of the next octave; of fractional Brownian motion, the sum of amplitudes
};

// Functions that add an octave of noise. `share`: less than 1 for the last octave of a detail that is no whole number.
void add_fbm(inout Octaves all, float noise, float share, bool normalized) {
    all.sum += noise * all.amplitude;
    all.weight += all.amplitude;
    all.value = mix(all.value, normalized ? 0.5 * all.sum / all.weight + 0.5 : all.sum, share);
}

void add_multifractal(inout Octaves all, float noise, float share) {
    all.weight *= share * all.amplitude * noise + 1.0;
    all.value = all.weight;
}

void add_hetero_terrain(inout Octaves all, float noise, float share, float offset) {
    all.value += share * (noise + offset) * all.amplitude * all.weight;
    all.weight = all.value;
}

void add_hybrid_multifractal(inout Octaves all, float noise, float share, float offset, float gain) {
    if (all.weight <= MIN_OCTAVE_WEIGHT) return;
    float signal = (noise + offset) * all.amplitude;
    all.weight = min(all.weight, 1.0);
    all.value += share * all.weight * signal;
    all.weight *= gain * signal;
}

// It has whole octaves only.
void add_ridged_multifractal(inout Octaves all, float noise, float share, float offset, float gain) {
    if (share < 1.0) return;
    float ridge = offset - abs(noise), signal = ridge * ridge * all.weight;
    all.value += signal * all.amplitude;
    all.weight = clamp(signal * gain, 0.0, 1.0);
}

const int FBM = 0, FBM_NORMALIZED = 1, MULTIFRACTAL = 2, HETERO_TERRAIN = 3, HYBRID_MULTIFRACTAL = 4;
const int RIDGED_MULTIFRACTAL = 5;

#define PARAMETERS vec4 p, float detail, float roughness, float lacunarity, float offset, float gain, int dimensions
#define ARGUMENTS p, detail, roughness, lacunarity, offset, gain, dimensions

float fractal_noise(int type, PARAMETERS) {
    Octaves all = Octaves(0.0, 0.0, 1.0, type == FBM || type == FBM_NORMALIZED ? 0.0 : 1.0);
    float count = octave_count(detail);
    for (int octave = 0; float(octave) < count; ++octave) {
        float noise = perlin_noise(p, dimensions), share = octave_share(count, octave);
        if (type == MULTIFRACTAL)
            add_multifractal(all, noise, share);
        else if (type == HETERO_TERRAIN)
            add_hetero_terrain(all, noise, share, offset);
        else if (type == HYBRID_MULTIFRACTAL)
            add_hybrid_multifractal(all, noise, share, offset, gain);
        else if (type == RIDGED_MULTIFRACTAL)
            add_ridged_multifractal(all, noise, share, offset, gain);
        else
            add_fbm(all, noise, share, type == FBM_NORMALIZED);
        all.amplitude *= roughness;
        p *= lacunarity;
    }
    return all.value;
}

vec3 fractal_noise_color(int type, PARAMETERS) {
    vec3 color;
    vec4 origin = p;
    for (int k = 0; k < 3; ++k) {
        // The seeds before are those of distortion.
        if (k > 0) p = origin + noise_offset(dimensions + k - 1, dimensions);
        color[k] = fractal_noise(type, ARGUMENTS);
    }
    return color;
}

#define NOISE(name, type) float name(PARAMETERS) { return fractal_noise(type, ARGUMENTS); }
NOISE(noise_fbm, FBM)
NOISE(noise_fbm_normalized, FBM_NORMALIZED)
NOISE(noise_multifractal, MULTIFRACTAL)
NOISE(noise_hetero_terrain, HETERO_TERRAIN)
NOISE(noise_hybrid_multifractal, HYBRID_MULTIFRACTAL)
NOISE(noise_ridged_multifractal, RIDGED_MULTIFRACTAL)

#define NOISE_COLOR(name, type) vec3 name(PARAMETERS) { return fractal_noise_color(type, ARGUMENTS); }
NOISE_COLOR(noise_fbm_color, FBM)
NOISE_COLOR(noise_fbm_normalized_color, FBM_NORMALIZED)
NOISE_COLOR(noise_multifractal_color, MULTIFRACTAL)
NOISE_COLOR(noise_hetero_terrain_color, HETERO_TERRAIN)
NOISE_COLOR(noise_hybrid_multifractal_color, HYBRID_MULTIFRACTAL)
NOISE_COLOR(noise_ridged_multifractal_color, RIDGED_MULTIFRACTAL)
