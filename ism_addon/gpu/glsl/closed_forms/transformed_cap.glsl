// Irradiance of a spherical cap of radiance 1 that is seen in a transformed space: as the ellipse that a disk becomes.
#include "maths/orthonormal_basis.glsl"
#include "closed_forms/ellipse.glsl"

// `sine`: of half of the cap's angle. Of receivers of normal z in the transformed space.
float transformed_cap_irradiance(vec3 axis, float sine, mat3 m) {
    if (sine >= 1.0) return 3.141592653589793; // inside
    mat3 frame = basis(axis);
    float radius = sine * inversesqrt(1.0 - sine * sine);
    vec3 centre = m * axis, u = m * frame[0] * radius, v = m * frame[1] * radius;
    vec3 across = cross(u, v), normal = across * inversesqrt(max(dot(across, across), 1e-37));
    return ellipse_irradiance(centre, u, v, vec3(0.0, 0.0, 1.0), dot(normal, centre) > 0.0 ? -normal : normal);
}
