// The colour that multiplies a light's emission: of its image, at each point of an area or in each direction of a spot; and
// of triangles of an emissive mesh.
#ifndef LIGHT_IMAGE
#define LIGHT_IMAGE 16 // points of a light whose mean colour is that of its irradiance; 0: no light has an image
#endif

#if LIGHT_IMAGE
vec3 light_texel(Light light, ivec2 at) {
    ivec2 size = ivec2(light.image_width, light.image_height);
    at = light.image_repeats != 0 ? (at + size) % size : clamp(at, ivec2(0), size - 1);
    return uintBitsToFloat(texelFetch(scene_records, light_texels + light.image + at.y * size.x + at.x).xyz);
}

// Texture coordinates of the light that arrives at p from a point of the light. Areas are covered by their image, by the
// point; spots project it, by the direction.
vec2 light_image_uv(Light light, vec3 p, vec3 point) {
    bool projects = dot(light.image_w, light.image_w) > 0.0;
    vec3 d = projects ? p - point : point - light.position;
    float depth = projects ? max(dot(d, light.image_w), 1e-30) : 1.0;
    return clamp(vec2(dot(d, light.image_u), dot(d, light.image_v)) / depth + 0.5, 0.0, 1.0);
}
#endif

// At a point of the light, on a triangle of an emissive mesh or -1.
vec3 light_color(Light light, vec3 p, vec3 point, int triangle) {
#if MESH_COLORS
    if (triangle >= 0) return emissive_color(triangle).color;
#endif
#if HAS_ENVIRONMENT
    if (light.shape == ENVIRONMENT) return environment_color(normalize(point - p));
#endif
#if LIGHT_IMAGE
    if (light.image < 0) return vec3(1.0);
    vec2 texel = light_image_uv(light, p, point) * vec2(light.image_width, light.image_height) - 0.5;
    vec2 part = fract(texel);
    ivec2 at = ivec2(floor(texel));
    vec3 below = mix(light_texel(light, at), light_texel(light, at + ivec2(1, 0)), part.x);
    vec3 above = mix(light_texel(light, at + ivec2(0, 1)), light_texel(light, at + 1), part.x);
    return mix(below, above, part.y);
#else
    return vec3(1.0);
#endif
}

// The mean over a light's irradiance.
vec3 light_mean_color(Light light, vec3 p, vec3 n) {
#if MESH_COLORS
    if (light.triangle_count > 0) return mean_color(emissive_mesh_colored_irradiance(light, p, n));
#endif
#if HAS_ENVIRONMENT
    if (light.shape == ENVIRONMENT) {
        vec3 irradiance = environment_irradiance_at(n);
        return irradiance / max(luminance(irradiance), 1e-30);
    }
#endif
#if LIGHT_IMAGE > 1
    if (light.image < 0) return vec3(1.0);
    vec4 sum = vec4(0.0);
    for (int k = 0; k < LIGHT_IMAGE; ++k) {
        LightSample from = light_sample(light, p, n, mean_point(k, LIGHT_IMAGE));
        float weight = from.radiance * max(dot(n, from.wi), 0.0) / from.pdf;
        sum += weight * vec4(light_color(light, p, from.point, from.triangle), 1.0);
    }
    return sum.rgb / max(sum.a, 1e-30);
#else
    return light_color(light, p, light.position, -1);
#endif
}

// The triangle of an emissive mesh that a ray from p meets; -1: of another light.
int light_triangle(Light light, vec3 p, vec3 wi) {
#if MESH_COLORS
    if (light.triangle_count > 0) return emissive_mesh_hit(light, p, wi).row;
#endif
    return -1;
}
