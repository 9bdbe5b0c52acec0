// Numbers start at 1: 0 is the background.
flat in uvec2 numbers;
uniform vec2 depth; // see depth.py
out uvec2 id;

void main() {
    id = numbers;
#if !REVERSED_DEPTH
    gl_FragDepth = depth.y < 0.0 ? depth.x - depth.y * log2(gl_FragCoord.w) : 1.0 - gl_FragCoord.z;
#endif
}
