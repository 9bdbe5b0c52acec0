// Rounding error of a point, m. A ray's ends are moved off their surfaces by it.
float rounding(vec3 p) { return 1e-6 * (abs(p.x) + abs(p.y) + abs(p.z)); }
