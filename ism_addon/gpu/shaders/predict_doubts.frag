// The most of a light that any pixel of a block is thought to see, and whether any of them is in doubt.
uniform sampler2D prediction;
uniform int first_row;
out vec2 most;

void main() {
    ivec2 block = ivec2(gl_FragCoord.xy) - ivec2(0, first_row), last = textureSize(prediction, 0) - 1;
    most = vec2(0.0);
    for (int k = 0; k < BLOCK * BLOCK; ++k)
        most = max(most, texelFetch(prediction, min(block * BLOCK + ivec2(k % BLOCK, k / BLOCK), last), 0).xy);
}
