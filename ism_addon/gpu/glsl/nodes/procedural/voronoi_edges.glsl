// Voronoi Textures of the features Distance to Edge and N-Sphere Radius.
#include "nodes/procedural/voronoi_cells.glsl"

// Squared distance below which points have no edge between them.
const float MIN_SQUARED_DISTANCE = 1e-4;

float edge_distance(vec4 p, float randomness, int options) {
    vec4 corner = floor(p), inside = p - corner, nearest = vec4(0.0);
    ivec4 cell = ivec4(corner);
    float square = NO_DISTANCE, dist = NO_DISTANCE;
    for (int i = 0; i < cell_count(1, options); ++i) {
        vec4 way = point_in(cell, cell_offset(i, 1, options), randomness, options) - inside;
        if (dot(way, way) < square) {
            square = dot(way, way);
            nearest = way;
        }
    }
    float limit = voronoi_dimensions(options) > 1 ? MIN_SQUARED_DISTANCE : 0.0;
    for (int i = 0; i < cell_count(1, options); ++i) {
        vec4 way = point_in(cell, cell_offset(i, 1, options), randomness, options) - inside, across = way - nearest;
        if (dot(across, across) > limit) dist = min(dist, dot(0.5 * (nearest + way), normalize(across)));
    }
    return dist;
}

float voronoi_distance_to_edge(vec4 p, float detail, float roughness, float lacunarity, float randomness, int options) {
    float spread = clamp(randomness, 0.0, 1.0), fade = clamp(roughness, 0.0, 1.0), amplitude = 1.0, scale = 1.0;
    float count = fade > 0.0 ? octave_count(detail) : 1.0;
    float farthest = 0.5 + 0.5 * spread, limit = farthest, result = 8.0;
    for (int i = 0; float(i) < count; ++i) {
        float weight = amplitude * octave_share(count, i);
        limit = mix(limit, farthest / scale, weight);
        result = mix(result, min(result, edge_distance(p * scale, spread, options) / scale), weight);
        scale *= lacunarity;
        amplitude *= fade;
    }
    return is_normalized(options) ? result / limit : result;
}

// Half of the distance from the nearest point to the point nearest to that.
float voronoi_n_sphere_radius(vec4 p, float randomness, int options) {
    vec4 corner = floor(p), inside = p - corner, nearest = vec4(0.0);
    ivec4 cell = ivec4(corner), nearest_offset = ivec4(0);
    float spread = clamp(randomness, 0.0, 1.0), square = NO_DISTANCE, next_square = NO_DISTANCE;
    for (int i = 0; i < cell_count(1, options); ++i) {
        ivec4 offset = cell_offset(i, 1, options);
        vec4 point = point_in(cell, offset, spread, options), way = point - inside;
        if (dot(way, way) < square) {
            square = dot(way, way);
            nearest = point;
            nearest_offset = offset;
        }
    }
    for (int i = 0; i < cell_count(1, options); ++i) {
        ivec4 offset = cell_offset(i, 1, options);
        vec4 way = point_in(cell, nearest_offset + offset, spread, options) - nearest;
        if (offset != ivec4(0)) next_square = min(next_square, dot(way, way));
    }
    return 0.5 * sqrt(next_square);
}
