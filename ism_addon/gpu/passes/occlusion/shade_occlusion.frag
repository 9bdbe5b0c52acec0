// What ambient occlusion leaves of white light, for the render pass AO.
#include "maths/luminance.glsl"
#include "surfaces/surface.glsl"
#if OCCLUSION
#include "occlusion/darkening.glsl"
#endif
layout(location = 0) out vec4 sample_occlusion;
layout(location = 1) out vec4 sample_occlusion_residual;
layout(location = 2) out float sample_occlusion_headroom;

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    Surface surface = surface_at(at);
    vec4 light = vec4(vec3(surface.exists ? 1.0 : 0.0), 0.0), residual = vec4(0.0);
#if OCCLUSION
    darken(darkening_at(at, surface), light, residual);
#endif
    sample_occlusion = vec4(light.rgb, surface.exists ? 1.0 : 0.0);
    sample_occlusion_residual = residual;
    sample_occlusion_headroom = light.a;
}
