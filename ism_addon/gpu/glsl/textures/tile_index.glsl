// The tile of a texel, in a target with a texel for each tile, in strips, see render_targets.py.
uniform int strip;   // texels to a row
uniform int columns; // tiles to a row

ivec2 tile_index() {
    int index = strip * int(gl_FragCoord.y) + int(gl_FragCoord.x);
    return ivec2(index % columns, index / columns);
}
