// The triangle's index plus 1, and the instance's index. 0 is the background.
flat in uvec2 triangle_and_instance;
uniform vec2 depth; // see depth.py
out uvec2 id;

void main() {
    id = triangle_and_instance;
#if !REVERSED_DEPTH
    gl_FragDepth = depth.y < 0.0 ? depth.x - depth.y * log2(gl_FragCoord.w) : 1.0 - gl_FragCoord.z;
#endif
}
