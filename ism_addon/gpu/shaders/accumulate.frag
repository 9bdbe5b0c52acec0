// One more sample; blending adds it.
uniform sampler2D color;
out vec4 sum;

void main() {
    sum = texelFetch(color, ivec2(gl_FragCoord.xy), 0);
}
