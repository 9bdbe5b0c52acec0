// A point of the octahedron's square in one float from 1 to 2, eleven bits an axis: beside a position it costs no fetch.
// Axes come out as they went in. 0 stands for no surface at all.
const float STEPS = 2048.0, SMALLEST = 1.0 / 8388608.0; // of the floats from 1 to 2

float pack_normal(vec2 octahedron) {
    vec2 steps = floor((0.5 * octahedron + 0.5) * (STEPS - 2.0) + 0.5);
    return 1.0 + (steps.x + STEPS * steps.y) * SMALLEST;
}

vec2 unpack_normal(float number) {
    float steps = (number - 1.0) / SMALLEST, y = floor(steps / STEPS);
    return vec2(steps - STEPS * y, y) * (2.0 / (STEPS - 2.0)) - 1.0;
}
