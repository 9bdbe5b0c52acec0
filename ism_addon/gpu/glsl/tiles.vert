// The blocks of pixels that take part in a sample: a point each, as large as they are.
in vec2 block;
in vec4 where;
in float number;
in float chance;
in float light;
in float part;
uniform float size;        // of a block, with what is drawn around it
uniform vec2 blocks;       // columns and rows; the viewport is theirs, which may reach beyond the picture
flat out vec4 place;       // fine pixel and place, in px, from those of the pixel's centre
flat out vec2 own_block;
flat out float own_chance; // see trace.py and dim.py
flat out float own_light;  // that the block is drawn for, where one is
flat out float own_part;   // of it that is thought to be seen
flat out float own_number; // of the sample, counting those that the block took part in

void main() {
    gl_Position = vec4((block + 0.5) / blocks * 2.0 - 1.0, 0.0, 1.0);
    gl_PointSize = size;
    own_block = block;
    place = where;
    own_number = number;
    own_chance = chance;
    own_light = light;
    own_part = part;
}
