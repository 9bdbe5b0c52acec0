// What a surface before the visible one lets pass, over the probability that a camera ray passes it.
#include "surfaces/instance_fragment.glsl"
out vec4 transmitted_color;

void main() {
    vec4 passes = passing(material_of_triangle());
    float view_z = (view_from_anchor * vec4(position, 1.0)).z;
    transmitted_color = vec4(passes.rgb / max(pass_probability(passes), 1e-30), view_z);
    write_depth();
}
