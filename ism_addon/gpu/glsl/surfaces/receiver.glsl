// What a shadow ray must know of the pixel that it starts from.
#include "surfaces/light_linking.glsl"
#include "maths/octahedron.glsl"
uniform sampler2D position;
uniform sampler2D normals;
uniform sampler2D albedo; // in alpha, how far the curved surface stands out
uniform usampler2D triangles;

uniform samplerBuffer memberships; // by instance

struct Receiver { vec3 position; vec3 normal; vec3 facet; vec3 albedo; float rise; int triangle; int instance; bool seen; };

Receiver receiver_at(ivec2 at) {
    vec4 p = fetch(position, at), octahedra = fetch(normals, at), color = fetch(albedo, at);
    uvec2 id = fetch(triangles, at).xy;
    return Receiver(p.xyz, direction_from_octahedron(octahedra.xy), direction_from_octahedron(octahedra.zw), color.rgb,
                    color.a, int(id.x) - 1, int(id.y), p.w > 0.0);
}

// Whether a light is linked to it.
bool receives(Receiver here, Light light) {
    return light.receivers < 0 || linked(fetch_Membership(memberships, here.instance).groups, light.receivers);
}
