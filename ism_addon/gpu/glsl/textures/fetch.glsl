// Fetches a texel like texelFetch. But texelFetch looks up a level of detail for each pixel, which takes software
// drivers longer than the fetch itself. Our textures have no mip levels and no filter. Loops pass the texel's size, so
// that it is computed once.
vec2 texel_size(sampler2D from) { return 1.0 / vec2(textureSize(from, 0)); }
vec2 texel_size(usampler2D from) { return 1.0 / vec2(textureSize(from, 0)); }

vec4 fetch(sampler2D from, ivec2 at, vec2 texel) { return textureLod(from, (vec2(at) + 0.5) * texel, 0.0); }
uvec4 fetch(usampler2D from, ivec2 at, vec2 texel) { return textureLod(from, (vec2(at) + 0.5) * texel, 0.0); }

vec4 fetch(sampler2D from, ivec2 at) { return fetch(from, at, texel_size(from)); }
uvec4 fetch(usampler2D from, ivec2 at) { return fetch(from, at, texel_size(from)); }
