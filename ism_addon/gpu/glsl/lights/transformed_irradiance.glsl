// About the irradiance of lights in transformed spaces, in which a glossy lobe is a cosine (Heitz, Dupuy, Hill & Neubelt
// 2016; Heitz & Hill 2017): parallelograms and ellipses keep their shapes there.

// In place of an even radiance: the light is even, and comes from all directions.
const float EVERYWHERE = -1.0;

#if HAS_AREA
bool area_is_delta(Light light, vec3 p) { return false; }

float area_even_radiance(Light light, vec3 p, vec3 n) {
    float lowest = dot(n, light.position - p) - 0.5 * (abs(dot(n, light.axis_u)) + abs(dot(n, light.axis_v)));
    return light.spread_scale == 0.0 && lowest >= 0.0 ? 1.0 : 0.0;
}

// In the transformed space too, the light is a parallelogram or an ellipse. About: the spread is that of its middle.
float area_transformed_irradiance(Light light, vec3 p, mat3 m) {
    vec3 centre = light.position - p, u = light.axis_u, v = light.axis_v;
    float height = -dot(light.normal, centre);
    if (height <= 0.0) return 0.0;
    float spread = spread_falloff(light, height, length(cross(light.normal, centre)));
    mat3 transformed = m * mat3(centre, u, v);
    transformed *= inversesqrt(max(dot(transformed[0], transformed[0]),
                                   max(dot(transformed[1], transformed[1]), dot(transformed[2], transformed[2]))));
    vec3 across = cross(transformed[1], transformed[2]), normal = across * inversesqrt(max(dot(across, across), 1e-37));
    if (dot(normal, transformed[0]) > 0.0) normal = -normal;
    return spread * area_shape_irradiance(light, transformed[0], transformed[1], transformed[2], vec3(0.0, 0.0, 1.0), normal);
}
#endif

#if HAS_POINT || HAS_SPOT
bool point_is_delta(Light light, vec3 p) { return !point_has_radius(light); }

float point_even_radiance(Light light, vec3 p, vec3 n) {
    PointCap cap = point_cap(light, p);
    return cap.sine < 1.0 && dot(n, cap.axis) >= cap.sine ? point_radiance(light) : 0.0;
}

float point_transformed_irradiance(Light light, vec3 p, mat3 m) {
    PointCap cap = point_cap(light, p);
    return point_has_radius(light) ? point_radiance(light) * transformed_cap_irradiance(cap.axis, cap.sine, m) : 0.0;
}
#endif

#if HAS_SPOT
bool spot_is_delta(Light light, vec3 p) { return point_is_delta(light, p); }

float spot_even_radiance(Light light, vec3 p, vec3 n) { return 0.0; }

float spot_transformed_irradiance(Light light, vec3 p, mat3 m) {
    float irradiance = point_transformed_irradiance(light, p, m);
    return irradiance == 0.0 ? 0.0 : irradiance * spot_factor(light, p, normalize(light.position - p));
}
#endif

#if HAS_SUN || HAS_MAP_SUN
bool sun_is_delta(Light light, vec3 p) { return !sun_has_angle(light); }

float sun_even_radiance(Light light, vec3 p, vec3 n) {
    return -dot(n, light.normal) >= light.radius ? sun_radiance(light) : 0.0;
}

float sun_transformed_irradiance(Light light, vec3 p, mat3 m) {
    return sun_has_angle(light) ? sun_radiance(light) * transformed_cap_irradiance(-light.normal, light.radius, m) : 0.0;
}
#endif

#if HAS_MAP_SUN
bool map_sun_is_delta(Light light, vec3 p) { return false; }

float map_sun_even_radiance(Light light, vec3 p, vec3 n) { return 0.0; }

float map_sun_transformed_irradiance(Light light, vec3 p, mat3 m) { return sun_transformed_irradiance(light, p, m); }
#endif

#if HAS_EMISSIVE_MESH
bool emissive_mesh_is_delta(Light light, vec3 p) { return false; }

float emissive_mesh_even_radiance(Light light, vec3 p, vec3 n) { return 0.0; } // triangles may hide each other

// Of few triangles; 0 of a light BVH: rays alone find what it adds to reflections.
vec4 emissive_mesh_transformed_colored_irradiance(Light light, vec3 p, mat3 m) {
    bool enclosed = emissive_mesh_encloses(light, p);
    vec4 sum = vec4(0.0);
    int last = has_light_bvh(light) ? light.first_triangle : light.first_triangle + light.triangle_count;
    for (int k = light.first_triangle; k < last; ++k) {
        EmissiveTriangle triangle = fetch_EmissiveTriangle(scene_records, emissive_triangles + k);
        if (is_edge_on(triangle, p) || !emits_towards(triangle, p, enclosed)) continue;
        mat3 corners = m * mat3(triangle.corner - p, triangle.u, triangle.v);
        float irradiance =
            triangle_irradiance(corners[0], corners[1], corners[2], vec3(0.0, 0.0, 1.0), SMALL_TRIANGLE);
        EmissiveColor of_triangle = emissive_color(k);
        sum += colored(irradiance * of_triangle.luminance, of_triangle.color);
    }
    return sum;
}

float emissive_mesh_transformed_irradiance(Light light, vec3 p, mat3 m) {
    return emissive_mesh_transformed_colored_irradiance(light, p, m).x;
}
#endif

#if HAS_ENVIRONMENT
const int ENVIRONMENT_TAPS = 8;

bool environment_is_delta(Light light, vec3 p) { return false; }

float environment_even_radiance(Light light, vec3 p, vec3 n) { return 0.0; }

// The irradiance by samples of the cosine, filtered by mip levels (Krivanek & Colbert 2008).
vec3 environment_transformed_color(mat3 m) {
    mat3 back = inverse(m);
    vec3 sum = vec3(0.0);
    float texel_at_equator = 2.0 * HALF_TURN * HALF_TURN / float(environment_size.x * environment_size.y);
    for (int k = 0; k < ENVIRONMENT_TAPS; ++k) {
        vec2 uv = vec2((float(k) + 0.5) / float(ENVIRONMENT_TAPS), float(bitfieldReverse(uint(k)) >> 8u) / 16777216.0);
        vec3 cosine_direction = cosine_hemisphere(uv), wi = back * cosine_direction;
        float size = length(wi), density = cosine_hemisphere_pdf(cosine_direction.z) * size * size * size * abs(determinant(m));
        wi /= size;
        float texel = texel_at_equator * max(sqrt(1.0 - wi.z * wi.z), 1e-3);
        float level = 0.5 * log2(1.0 / (float(ENVIRONMENT_TAPS) * density * texel));
        sum += environment_radiance(wi, clamp(int(level + 0.5), 0, findMSB(environment_size.y)));
    }
    return sum * (HALF_TURN / float(ENVIRONMENT_TAPS));
}

float environment_transformed_irradiance(Light light, vec3 p, mat3 m) {
    return luminance(environment_transformed_color(m));
}
#endif

#if HAS_WORLD
bool world_is_delta(Light light, vec3 p) { return false; }

float world_even_radiance(Light light, vec3 p, vec3 n) { return EVERYWHERE; }

float world_transformed_irradiance(Light light, vec3 p, mat3 m) { return 3.141592653589793; }
#endif
