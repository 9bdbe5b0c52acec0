// Composition in linear light.
#include "lib/half.glsl"
#include "lib/surface.glsl"
uniform sampler2D albedo;
uniform sampler2D irradiance;
uniform sampler2D occlusion;
uniform vec3 world;
uniform float background;
out vec4 color;

// Bilinear between the four nearest half-resolution pixels, as far as they show the surface that is here.
float open_part(ivec2 at, Surface here) {
    ivec2 size = textureSize(occlusion, 0), full_size = textureSize(position, 0);
    if (size == ivec2(1)) return texelFetch(occlusion, ivec2(0), 0).x;
    ivec2 low = at / 2;
    vec2 f = 0.5 * vec2(at & 1);
    float sum = 0.0, weights = 0.0;
    for (int k = 0; k < 4; ++k) {
        ivec2 step = ivec2(k & 1, k >> 1);
        ivec2 neighbour = min(low + step, size - 1);
        vec2 near = mix(1.0 - f, f, vec2(step));
        float weight = near.x * near.y * (alike(here, surface_at(full_from_half(neighbour, full_size))) + 1e-4);
        sum += weight * texelFetch(occlusion, neighbour, 0).x;
        weights += weight;
    }
    return sum / weights;
}

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    Surface here = surface_at(at);
    if (!here.seen) {
        color = background * vec4(world, 1.0);
        return;
    }
    // A Lambertian surface sends its albedo's part of what arrives, spread over pi; from a world of one radiance
    // arrives pi times that.
    vec3 arriving = texelFetch(irradiance, min(at, textureSize(irradiance, 0) - 1), 0).rgb / 3.141592653589793;
    color = vec4(texelFetch(albedo, at, 0).rgb * (arriving + world * open_part(at, here)), 1.0);
}
