// Object to clip space of the fine picture, see sampling.Grid. The mesh stands where its instance's rows say.
uniform int first_instance;
uniform mat2 turn;
uniform vec2 shift;
in vec3 position;
in vec4 row0;
in vec4 row1;
in vec4 row2;
flat out uvec2 numbers; // of the triangle and the instance

void main() {
    numbers = uvec2(gl_VertexID + 1, first_instance + gl_InstanceID);
    vec4 p = vec4(position, 1.0);
    gl_Position = clip_from_anchor * vec4(dot(row0, p), dot(row1, p), dot(row2, p), 1.0);
    gl_Position.xy = turn * gl_Position.xy + shift * gl_Position.w;
}
