// Which graphs the pixels of a tile's cell have in this sample, a bit for each; those of 32 graphs and more share bits.
#include "trace/triangle_fetch.glsl"
#include "surfaces/visible_triangle.glsl"
uniform usamplerBuffer materials;
uniform int background_graph; // of the program that draws the background too
layout(location = 0) out uint tile_graphs;

void main() {
    ivec2 corner = ivec2(gl_FragCoord.xy) * CELL_SIZE;
    tile_graphs = 0u;
    for (int k = 0; k < CELL_SIZE * CELL_SIZE; ++k) {
        ivec2 pixel = min(corner + ivec2(k % CELL_SIZE, k / CELL_SIZE), last_pixel());
        uvec2 id = visible_triangle(vec2(pixel));
        int material = fetch_triangle(max(int(id.x) - 1, 0)).material;
        int graph = id.x == 0u ? background_graph : fetch_Material(materials, material).graph;
        tile_graphs |= 1u << uint(graph + 1 & 31);
    }
}
