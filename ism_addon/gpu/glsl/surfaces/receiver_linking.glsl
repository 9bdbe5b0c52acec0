// Whether a light is linked to a surface.
#include "surfaces/light_linking.glsl"
#include "surfaces/surface.glsl"
#include "textures/scene_records.glsl"
uniform int link_groups; // rows of MEMBERSHIP, by instance

bool is_lit_by(Surface surface, Light light) {
    if (light.receivers < 0) return true;
    return is_linked(fetch_Membership(scene_records, link_groups + surface.instance).groups, light.receivers);
}
