// Draws tiles as points of a tile's size. See TILE in tiles.py.
in vec2 in_tile;
in vec4 in_visibility_texel_and_offset;
in float in_sample_index;
in float in_probability;
in int in_light;
in float in_visibility;
in float in_tolerance;
uniform float size;       // of a tile with its margin, px
uniform vec2 tile_counts; // columns and rows; the viewport covers all tiles, and may be larger than the picture
#ifdef GRAPH_CELLS
uniform usampler2D tile_graphs; // see find_graphs.frag
uniform uint graph_bits; // of the graphs that are drawn
#endif
flat out vec2 tile;
flat out vec4 visibility_texel_and_offset; // px, from the pixel's centre
flat out float sample_index;               // among the tile's samples
flat out float tile_probability;           // with which it is drawn; 0 if each pixel has a different one
flat out int tile_light;                   // index of the light that is drawn
flat out float tile_visibility;            // predicted for all of its pixels; below 0 if each pixel has a different one
flat out float tile_tolerance;             // change of luminance that is as visible as 1 where the picture's mean is

void main() {
    gl_Position = vec4((in_tile + 0.5) / tile_counts * 2.0 - 1.0, 0.0, 1.0);
    gl_PointSize = size;
#ifdef GRAPH_CELLS
    uint graphs = 0u;
    ivec2 last = textureSize(tile_graphs, 0) - 1;
    for (int k = 0; k < GRAPH_CELLS * GRAPH_CELLS; ++k) {
        ivec2 cell = ivec2(in_tile) * GRAPH_CELLS + ivec2(k % GRAPH_CELLS, k / GRAPH_CELLS);
        graphs |= texelFetch(tile_graphs, min(cell, last), 0).x;
    }
    if ((graphs & graph_bits) == 0u) gl_Position = vec4(2.0, 2.0, 2.0, 1.0); // clipped
#endif
    tile = in_tile;
    visibility_texel_and_offset = in_visibility_texel_and_offset;
    sample_index = in_sample_index;
    tile_probability = in_probability;
    tile_light = in_light;
    tile_visibility = in_visibility;
    tile_tolerance = in_tolerance;
}
