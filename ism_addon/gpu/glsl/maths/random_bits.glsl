// Random bits of four numbers (Jarzynski & Olano 2020: pcg3d, after one step for the fourth).
uvec3 random_bits(uvec3 v, uint seed) {
    v = (v ^ seed) * 1664525u + 1013904223u;
    v += v.yzx * v.zxy;
    v ^= v >> 16;
    return v + v.yzx * v.zxy;
}
