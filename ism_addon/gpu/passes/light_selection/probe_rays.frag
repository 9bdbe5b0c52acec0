// Probe rays: each texel traces a ray from one pixel to a light. Texels lie in blocks; a block's rays go to one light.
#include "surfaces/receiver_linking.glsl"
#include "trace/shadow_ray.glsl"
#include "lights/portal_rays.glsl"
uniform usamplerBuffer probe_blocks;
uniform int first_block;
uniform int block_columns;  // blocks side by side
uniform ivec2 block_size;   // texels
uniform int spacing;        // px, from the first pixel of a texel to that of the next
uniform ivec2 pixel_offset; // px, from a texel's first pixel to the one that the ray starts from
out vec2 rays;              // unoccluded, traced

// If the sampled point is below the horizon, but not all of the light, visibility is unknown: half of the ray counts as
// unoccluded. No ray is counted if all of the light is below the horizon, or if a light BVH has led to triangles that do
// not emit towards the surface; nor of the world, as a direction below the horizon says nothing of those above.
vec2 probe(Surface surface, Light light, vec2 light_uv) {
    if (!surface.exists) return vec2(0.0);
    if (!is_lit_by(surface, light)) return vec2(0.0, 1.0);
    LightSample from = light_sample(light, surface.position, surface.normal, light_uv);
    if (arrives(surface, from)) {
        float visible = mean(shadow_transmittance(surface, from.point, light));
        return vec2(visible * ray_weight(light, surface.normal, from), 1.0);
    }
    if (light.leaves > 0 || light.shape == WORLD || light.shape == ENVIRONMENT) return vec2(0.0);
    return light_irradiance(light, surface.position, surface.normal) > 0.0 ? vec2(0.5, 1.0) : vec2(0.0);
}

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy), in_grid = texel / block_size;
    ProbeBlock block = fetch_ProbeBlock(probe_blocks, first_block + in_grid.y * block_columns + in_grid.x);
    ivec2 at = block.first_texel + texel - in_grid * block_size;
    rays = vec2(0.0);
    if (block.light < 0) return;
    Surface surface = surface_at(min(spacing * at + pixel_offset, last_pixel()));
    rays = probe(surface, fetch_Light(scene_records, lights + block.light), pixel_sequence(at, block.light_uv));
}
