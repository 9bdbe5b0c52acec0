// Voronoi Textures of the features F1, F2 and Smooth F1: what the nearest points give.
#include "nodes/procedural/voronoi_cells.glsl"

const int EUCLIDEAN = 0, MANHATTAN = 1, CHEBYCHEV = 2;

// What a point gives.
struct Voronoi {
    float distance;
    vec3 color;
    vec4 position;
};

// How points are spread and their distances measured.
struct VoronoiShape {
    float smoothness;
    float exponent;
    float randomness;
};

// What is in the order of distances, and the distance.
float distance_order(vec4 d, float exponent, int options) {
    int metric = voronoi_metric(options), dimensions = voronoi_dimensions(options);
    d = abs(d);
    if (metric == EUCLIDEAN) return dot(d, d);
    if (metric == MANHATTAN) return d.x + d.y + d.z + d.w;
    if (metric == CHEBYCHEV) return max(max(d.x, d.y), max(d.z, d.w));
    float sum = pow(d.x, exponent) + pow(d.y, exponent);
    if (dimensions > 2) sum += pow(d.z, exponent);
    return dimensions > 3 ? sum + pow(d.w, exponent) : sum;
}

float distance_of(float order, float exponent, int options) {
    int metric = voronoi_metric(options);
    if (metric == EUCLIDEAN) return sqrt(order);
    return metric == MANHATTAN || metric == CHEBYCHEV ? order : pow(order, 1.0 / exponent);
}

// The nearest point, or the next one.
Voronoi nearest_point(vec4 p, VoronoiShape shape, bool is_second, int options) {
    vec4 corner = floor(p), inside = p - corner, nearest = vec4(0.0), second = vec4(0.0);
    ivec4 cell = ivec4(corner), nearest_offset = ivec4(0), second_offset = ivec4(0);
    float order = NO_DISTANCE, second_order = NO_DISTANCE;
    for (int i = 0; i < cell_count(1, options); ++i) {
        ivec4 offset = cell_offset(i, 1, options);
        vec4 point = point_in(cell, offset, shape.randomness, options);
        float point_order = distance_order(point - inside, shape.exponent, options);
        if (point_order < order) {
            second_order = order;
            second = nearest;
            second_offset = nearest_offset;
            order = point_order;
            nearest = point;
            nearest_offset = offset;
        } else if (point_order < second_order) {
            second_order = point_order;
            second = point;
            second_offset = offset;
        }
    }
    if (is_second) {
        order = second_order;
        nearest = second;
        nearest_offset = second_offset;
    }
    float dist = distance_of(order, shape.exponent, options);
    return Voronoi(dist, cell_color(cell + nearest_offset, options), corner + nearest);
}

// The nearest point, blended with others.
Voronoi smooth_point(vec4 p, VoronoiShape shape, int options) {
    vec4 corner = floor(p), inside = p - corner;
    ivec4 cell = ivec4(corner);
    Voronoi blend = Voronoi(NO_DISTANCE, vec3(0.0), vec4(0.0));
    float width = max(shape.smoothness, 1e-6);
    for (int i = 0; i < cell_count(2, options); ++i) {
        ivec4 offset = cell_offset(i, 2, options);
        if (shape.smoothness == 0.0 && any(greaterThan(abs(offset), ivec4(1)))) continue; // as for the nearest point
        vec4 point = point_in(cell, offset, shape.randomness, options);
        float order = distance_order(point - inside, shape.exponent, options);
        float dist = distance_of(order, shape.exponent, options);
        float t = smoothstep(0.0, 1.0, 0.5 + 0.5 * (blend.distance - dist) / width);
        float correction = width * t * (1.0 - t), less = correction / (1.0 + 3.0 * width);
        // Not mix(), which may compute a difference: the first distance is huge.
        blend.distance = blend.distance * (1.0 - t) + dist * t - correction;
        blend.color = mix(blend.color, cell_color(cell + offset, options), t) - less;
        blend.position = mix(blend.position, point, t) - less;
    }
    blend.position += corner;
    return blend;
}

const int NEAREST = 0, SECOND = 1, SMOOTH = 2;

// A sum of octaves, in which positions are mixed.
Voronoi fractal_voronoi(int feature, vec4 p, float detail, float roughness, float lacunarity, VoronoiShape shape,
                        int options) {
    shape.randomness = clamp(shape.randomness, 0.0, 1.0);
    shape.smoothness = clamp(shape.smoothness / 2.0, 0.0, 0.5);
    float fade = clamp(roughness, 0.0, 1.0), count = fade > 0.0 ? octave_count(detail) : 1.0;
    float amplitude = 1.0, sum = 0.0, scale = 1.0;
    Voronoi result = Voronoi(0.0, vec3(0.0), vec4(0.0));
    for (int i = 0; float(i) < count; ++i) {
        Voronoi octave;
        if (feature == SMOOTH)
            octave = smooth_point(p * scale, shape, options);
        else
            octave = nearest_point(p * scale, shape, feature == SECOND, options);
        float weight = amplitude * octave_share(count, i);
        sum += weight;
        result.distance += weight * octave.distance;
        result.color += weight * octave.color;
        result.position = mix(result.position, octave.position / scale, weight);
        scale *= lacunarity;
        amplitude *= fade;
    }
    if (is_normalized(options)) {
        vec4 farthest = within_dimensions(vec4(0.5 + 0.5 * shape.randomness), voronoi_dimensions(options));
        float order = distance_order(farthest, shape.exponent, options);
        float limit = distance_of(order, shape.exponent, options) * (feature == SECOND ? 2.0 : 1.0);
        result.distance /= sum * limit;
        result.color /= sum;
    }
    return result;
}

Voronoi voronoi_f1(vec4 p, float detail, float roughness, float lacunarity, float exponent, float randomness,
                   int options) {
    return fractal_voronoi(NEAREST, p, detail, roughness, lacunarity, VoronoiShape(0.0, exponent, randomness), options);
}

Voronoi voronoi_f2(vec4 p, float detail, float roughness, float lacunarity, float exponent, float randomness,
                   int options) {
    return fractal_voronoi(SECOND, p, detail, roughness, lacunarity, VoronoiShape(0.0, exponent, randomness), options);
}

Voronoi voronoi_smooth_f1(vec4 p, float detail, float roughness, float lacunarity, float exponent, float randomness,
                          float smoothness, int options) {
    VoronoiShape shape = VoronoiShape(smoothness, exponent, randomness);
    return fractal_voronoi(SMOOTH, p, detail, roughness, lacunarity, shape, options);
}

float voronoi_distance(Voronoi v) { return v.distance; }
vec3 voronoi_color(Voronoi v) { return v.color; }

// Without what smooth positions have in further dimensions. Of one dimension, the position is the fourth number.
vec4 voronoi_position(Voronoi v, int dimensions) {
    return dimensions == 1 ? vec4(0.0, 0.0, 0.0, v.position.x) : within_dimensions(v.position, dimensions);
}
