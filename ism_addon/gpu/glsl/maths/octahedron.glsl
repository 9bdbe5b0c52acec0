// Unit vectors as points of a square (Cigolle et al. 2014). Great circles stay straight within an octant.

vec2 octahedron_from_direction(vec3 d) {
    vec2 p = d.xy / (abs(d.x) + abs(d.y) + abs(d.z));
    vec2 folded = (1.0 - abs(p.yx)) * vec2(p.x >= 0.0 ? 1.0 : -1.0, p.y >= 0.0 ? 1.0 : -1.0);
    return d.z >= 0.0 ? p : folded;
}

vec3 direction_from_octahedron(vec2 p) {
    vec3 d = vec3(p, 1.0 - abs(p.x) - abs(p.y));
    float below = max(-d.z, 0.0);
    d.xy += vec2(d.x >= 0.0 ? -below : below, d.y >= 0.0 ? -below : below);
    return normalize(d);
}

// Steps of a packed coordinate from 0 to 1.
const float OCTAHEDRON_STEPS = 32767.0;

// Such a point in 32 bits. Directions along the axes are exact.
uint pack_octahedron(vec2 p) {
    ivec2 steps = ivec2(floor(OCTAHEDRON_STEPS * p + 0.5));
    return uint(steps.x & 0xffff) | uint(steps.y << 16);
}

vec2 unpack_octahedron(uint bits) { return vec2(int(bits << 16u) >> 16, int(bits) >> 16) / OCTAHEDRON_STEPS; }

// The upper hemisphere alone fills a square that is rotated by 45 degrees.
vec2 square_from_hemisphere(vec3 d) {
    vec2 p = d.xy / (abs(d.x) + abs(d.y) + abs(d.z));
    return vec2(p.x + p.y, p.x - p.y);
}

vec3 hemisphere_from_square(vec2 s) {
    vec2 p = 0.5 * vec2(s.x + s.y, s.x - s.y);
    return normalize(vec3(p, 1.0 - abs(p.x) - abs(p.y)));
}
