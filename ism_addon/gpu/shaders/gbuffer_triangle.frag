// Numbers start at 1: 0 is the background.
uniform int first_triangle;
flat in int instance;
out uvec2 id;

void main() {
    id = uvec2(first_triangle + gl_PrimitiveID + 1, instance);
}
