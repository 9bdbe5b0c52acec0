// Numbers start at 1: 0 is the background.
flat in uvec2 numbers;
uniform vec2 logarithm; // see gbuffer.py
out uvec2 id;

void main() {
    id = numbers;
    // OpenGL's own depth is fine at the near plane alone: with one at 1 cm, as viewports have, 6 cm are one step at 100 m.
    gl_FragDepth = logarithm.y > 0.0 ? -(log2(gl_FragCoord.w) + logarithm.x) * logarithm.y : gl_FragCoord.z;
}
