// An octahedral normal in one float from 1 to 2, eleven bits per coordinate, so that it needs no fetch beside the
// position. Normals along the axes are exact. 0 stands for no surface.
const float STEPS = 2048.0, SMALLEST = 1.0 / 8388608.0; // SMALLEST: the spacing of floats from 1 to 2

float pack_normal(vec2 octahedron) {
    vec2 steps = floor((0.5 * octahedron + 0.5) * (STEPS - 2.0) + 0.5);
    return 1.0 + (steps.x + STEPS * steps.y) * SMALLEST;
}

vec2 unpack_normal(float value) {
    float steps = (value - 1.0) / SMALLEST, y = floor(steps / STEPS);
    return vec2(steps - STEPS * y, y) * (2.0 / (STEPS - 2.0)) - 1.0;
}
