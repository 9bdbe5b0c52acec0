// A texel of a level: depth in m, and the fraction of the texel that it covers.
uniform sampler2D fine;
uniform bool finest;
uniform float threshold;

vec2 fine_texel(ivec2 at) {
    vec2 texel = fetch(fine, at).xy;
    return finest ? vec2(texel.x, texel.x < EMPTY ? 1.0 : 0.0) : texel;
}
