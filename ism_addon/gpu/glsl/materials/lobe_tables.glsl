// Tables of glossy lobes: see gpu/materials/lobe_tables.py. roughness: the square root of GGX's alpha; cos_view: of the
// angle between the normal and the viewer. Both in 0 to 1.
#include "materials/lobe_table_layout.glsl"
#include "materials/ltc.glsl"

uniform samplerBuffer lobe_tables;

// Interpolates a table of size x size rows bilinearly; x and y are in 0 to 1.
vec4 lobe_table(int first, int size, float x, float y) {
    vec2 at = clamp(vec2(x, y), 0.0, 1.0) * float(size - 1);
    ivec2 cell = min(ivec2(at), size - 2);
    vec2 f = at - vec2(cell);
    int row = first + cell.x * size + cell.y;
    return mix(mix(texelFetch(lobe_tables, row), texelFetch(lobe_tables, row + 1), f.y),
               mix(texelFetch(lobe_tables, row + size), texelFetch(lobe_tables, row + size + 1), f.y), f.x);
}

// The table's entry for a linearly transformed cosine, see materials/ltc.glsl: each number is between -2 and 2. Use a
// roughness of .01 or more: at .01, float32 already moves a light by a thousandth of the lobe's width.
vec4 ltc_entry(float roughness, float cos_view) {
    return lobe_table(LTC_ROWS, LTC_SIZE, roughness, sqrt(1.0 - clamp(cos_view, 0.0, 1.0)));
}

vec4 ltc_inverse(float roughness, float cos_view) {
    return ltc_inverse_of(ltc_entry(roughness, cos_view), roughness, cos_view);
}

// Directional albedo of GGX without Fresnel, single scattering.
float ggx_albedo(float roughness, float cos_view) {
    return lobe_table(ALBEDO_ROWS, ALBEDO_SIZE, roughness, cos_view).w;
}

// Its mean over directions, weighted by the cosine.
float ggx_mean_albedo(float roughness) {
    float at = clamp(roughness, 0.0, 1.0) * float(ALBEDO_SIZE - 1);
    int cell = min(int(at), ALBEDO_SIZE - 2), row = MEAN_ALBEDO_ROWS + cell;
    return mix(texelFetch(lobe_tables, row).x, texelFetch(lobe_tables, row + 1).x, at - float(cell));
}

// A dielectric's albedo is mix(f0, f90, s) times that of GGX with multiple scattering. eta: its index of refraction.
float dielectric_s(float roughness, float cos_view, float eta) {
    float at = clamp(sqrt(abs((eta - 1.0) / (eta + 1.0))), 0.0, 1.0) * float(SHAPE_SIZE - 1);
    int slice = min(int(at), SHAPE_SIZE - 2);
    vec4 pair = lobe_table(SHAPE_ROWS + slice * SHAPE_SIZE * SHAPE_SIZE, SHAPE_SIZE, roughness, cos_view);
    return mix(pair.x, pair.y, at - float(slice));
}

// Directional albedo of a dielectric with what it transmits, single scattering. eta: from 1 to 14.
float glass_albedo(float roughness, float cos_view, float eta) {
    float at = clamp(sqrt(abs((eta - 1.0) / (eta + 1.0))) * float(SHAPE_SIZE - 1), 0.0, float(SHAPE_SIZE - 2));
    int slice = min(int(at), SHAPE_SIZE - 3), size = SHAPE_SIZE * SHAPE_SIZE;
    return mix(lobe_table(SHAPE_ROWS + slice * size, SHAPE_SIZE, roughness, cos_view).w,
               lobe_table(SHAPE_ROWS + (slice + 1) * size, SHAPE_SIZE, roughness, cos_view).w, at - float(slice));
}

// Its mean over directions, weighted by the cosine.
float glass_mean_albedo(float roughness, float eta) {
    return lobe_table(MEAN_GLASS_ROWS, SHAPE_SIZE, roughness, sqrt(abs((eta - 1.0) / (eta + 1.0)))).x;
}

// dielectric_s for Schlick's Fresnel.
float schlick_s(float roughness, float cos_view) { return lobe_table(SHAPE_ROWS, SHAPE_SIZE, roughness, cos_view).z; }

// Sheen: a, b of the inverse matrix [[a, 0, b], [0, a, 0], [0, 0, 1]], coordinates as above, and its albedo. Here
// roughness is Blender's.
vec3 sheen_ltc(float roughness, float cos_view) {
    return lobe_table(ALBEDO_ROWS, ALBEDO_SIZE, roughness, cos_view).xyz;
}
