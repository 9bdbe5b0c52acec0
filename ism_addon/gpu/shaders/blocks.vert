// The blocks of pixels that take part in a sample: a point each, as large as they are.
in vec2 block;
uniform vec2 blocks; // columns and rows; the viewport is theirs, which may reach beyond the picture

void main() {
    gl_Position = vec4((block + 0.5) / blocks * 2.0 - 1.0, 0.0, 1.0);
    gl_PointSize = float(BLOCK);
}
