// Which block the texel stands for, of a target with one for each, in strips, see render_targets.py.
uniform int strip;   // texels to a row
uniform int columns; // blocks to a row

ivec2 block_here() {
    int number = strip * int(gl_FragCoord.y) + int(gl_FragCoord.x);
    return ivec2(number % columns, number / columns);
}
