// Whether a light is linked to a surface.
#include "surfaces/light_linking.glsl"
#include "surfaces/surface.glsl"
uniform usamplerBuffer link_groups; // by instance

bool is_lit_by(Surface surface, Light light) {
    return light.receivers < 0 || is_linked(fetch_Membership(link_groups, surface.instance).groups, light.receivers);
}
