// Object to clip space of the fine picture, see sampling.Grid. The mesh stands where its instance's row says.
uniform sampler2D instances;
uniform int first_instance;
uniform mat2 turn;
uniform vec2 shift;
in vec3 position;
flat out uvec2 numbers; // of the triangle and the instance

void main() {
    int instance = first_instance + gl_InstanceID;
    numbers = uvec2(gl_VertexID + 1, instance);
    Instance here = fetch_Instance(instances, instance);
    vec4 p = vec4(position, 1.0);
    gl_Position = clip_from_anchor * vec4(dot(here.row0, p), dot(here.row1, p), dot(here.row2, p), 1.0);
    gl_Position.xy = turn * gl_Position.xy + shift * gl_Position.w;
}
