// The visible fraction of a cone about the normal, by horizons of the visible surfaces in a slice through the direction to
// the camera (Jimenez et al. 2016). A bit mask has the occluded parts of a slice, so that light passes behind thin
// surfaces (Therrien et al. 2023). Its bits are equal parts of the cosine-weighted solid angle. Each step of the search
// stands for the surface up to the middle of the next ones: without that, most occlude less than they do.
#include "maths/octahedron.glsl"
#include "maths/packed_normal.glsl"
#include "textures/half_resolution.glsl"
#include "maths/orthonormal_basis.glsl"
#include "surfaces/camera_ray.glsl"
#include "maths/project.glsl"
#include "occlusion/radius.glsl"
#include "sampling/pixel_sequence.glsl"

uniform sampler2D position;
uniform usampler2D normal; // see surfaces/surface.glsl
uniform uvec2 turn_shift; // of the sample, in the sequence over the picture: of the slice, and of the distances
uniform float cone_cosine; // of half of the cone's angle
uniform float attenuation;
uniform float thickness; // of surfaces, along the direction to the camera, in radii
out float raw_occlusion; // 1 is open

const float PI = 3.141592653589793;
const float BITS = 32.0;

// The least cosine of a surface to the camera: what is seen at grazing angles would have no end.
const float MIN_COSINE = 0.04;

// The least sine of an occluder's elevation above the pixel's plane: facets of smooth surfaces are not quite in it.
const float MIN_ELEVATION_SINE = 0.05;

// The directions of a slice by their angle from the direction to the camera; n: that of the normal in the slice.
// `depth`: of surfaces along the direction to the camera, m.
struct Slice { vec3 to_camera; vec3 across; float n; float low; float high; float before_low; float all; float depth; };

// The integral from 0 to `angle` of cos(x - n) |sin x|.
float weight_to(float angle, float n) {
    float integral = 0.25 * (cos(n) - cos(2.0 * angle - n) + 2.0 * angle * sin(n));
    return angle < 0.0 ? -integral : integral;
}

// The bits of a slice between two angles.
uint bits_between(Slice slice, float from, float to) {
    vec2 angles = clamp(vec2(from, to), slice.low, slice.high);
    vec2 ends = vec2(weight_to(angles.x, slice.n), weight_to(angles.y, slice.n));
    uvec2 bits = uvec2(clamp((ends - slice.before_low) / slice.all, 0.0, 1.0) * BITS + 0.5);
    uint count = bits.y > bits.x ? bits.y - bits.x : 0u;
    return count == 0u ? 0u : (count == 32u ? 0xffffffffu : ((1u << count) - 1u) << bits.x);
}

// Of a receiver's normal, in the slice through a vector parallel to the screen. Its weight is |projected normal| * all.
Slice slice_of(vec3 to_camera, vec3 along, vec3 n, float depth, out float weight) {
    vec3 across = normalize(along - dot(along, to_camera) * to_camera);
    vec2 projected = vec2(dot(n, across), dot(n, to_camera));
    float size = max(length(projected), 1e-6), angle = atan(projected.x, projected.y);
    float reach = acos(clamp(cone_cosine / size, 0.0, 1.0));
    Slice slice = Slice(to_camera, across, angle, angle - reach, angle + reach, 0.0, 0.0, depth);
    slice.before_low = weight_to(slice.low, angle);
    slice.all = weight_to(slice.high, angle) - slice.before_low;
    weight = size * slice.all;
    return slice;
}

// The least and the largest angle of a surface around `front`: of its part up to half a step to both sides along the
// slice, and of what is behind it.
vec2 angles_of(Slice slice, vec3 front, vec4 occluder, float step) {
    vec3 n = direction_from_octahedron(unpack_normal(occluder.w)), to_camera = direction_to_camera(occluder.xyz);
    float slope = -dot(n, slice.across) / max(dot(n, to_camera), MIN_COSINE);
    vec3 half_part = 0.5 * step * (slice.across + slope * to_camera);
    vec3 ends[3] = vec3[3](front - half_part, front + half_part, front - slice.depth * slice.to_camera);
    vec2 direction = vec2(dot(front, slice.across), dot(front, slice.to_camera)), turns = vec2(0.0);
    // Relative to the direction to `front`: angles from the camera's direction jump by 2 PI below the receiver.
    for (int k = 0; k < 3; ++k) {
        vec2 end = vec2(dot(ends[k], slice.across), dot(ends[k], slice.to_camera));
        float turn = atan(end.x * direction.y - end.y * direction.x, dot(end, direction));
        turns = vec2(min(turns.x, turn), max(turns.y, turn));
    }
    return atan(direction.x, direction.y) + turns;
}

void main() {
    ivec2 at = full_from_half(ivec2(gl_FragCoord.xy));
    vec4 receiver = fetch(position, at);
    raw_occlusion = 1.0;
    if (receiver.w == 0.0) return;
    vec3 p = receiver.xyz, to_camera = direction_to_camera(p);
    float radius = occlusion_radius(p);
    uvec2 octahedra = fetch(normal, at).xy;
    vec3 n = direction_from_octahedron(unpack_octahedron(octahedra.x));
    vec3 geometric_normal = direction_from_octahedron(unpack_octahedron(octahedra.y));
    vec2 subpixel_offset = project(p).xy - (vec2(at) + 0.5);
    mat3 screen = basis(to_camera);
    // In narrow cones, only a slice around the normal's own: others miss the cone.
    vec2 tilt = (n * screen).xy;
    float tilt_sine = length(tilt), cone_sine = sqrt(max(1.0 - cone_cosine * cone_cosine, 0.0));
    float middle = tilt_sine > 0.0 ? atan(tilt.y, tilt.x) : 0.0;
    float range = cone_sine < tilt_sine ? asin(cone_sine / tilt_sine) : 0.5 * PI;
    vec2 shift = pixel_sequence(ivec2(gl_FragCoord.xy), turn_shift);
    float turn = middle + range * (2.0 * shift.x - 1.0), weight;
    vec3 along = screen * vec3(cos(turn), sin(turn), 0.0);
    Slice slice = slice_of(to_camera, along, n, thickness * radius, weight);
    if (weight <= 1e-6) return;
    uint mask = 0u;
    float occluded = 0.0, step = radius / float(STEPS_TO_A_SIDE);
    for (int j = 0; j < 2 * STEPS_TO_A_SIDE; ++j) {
        float side = (j & 1) == 0 ? 1.0 : -1.0;
        vec3 pixel = project(p + along * (side * step * (float(j / 2) + shift.y)));
        ivec2 from = ivec2(floor(pixel.xy - subpixel_offset));
        bool is_inside = all(greaterThanEqual(from, ivec2(0))) && all(lessThanEqual(from, last_pixel()));
        if (from == at || pixel.z <= 0.0 || !is_inside) continue;
        vec4 occluder = fetch(position, from);
        vec3 front = occluder.xyz - p;
        float distance = length(front);
        // Surfaces in the pixel's plane occlude nothing, nor do those further away than the radius.
        bool is_above = dot(front, geometric_normal) > MIN_ELEVATION_SINE * distance;
        if (occluder.w == 0.0 || distance > radius || !is_above) continue;
        vec2 angles = angles_of(slice, front, occluder, step);
        uint bits = bits_between(slice, angles.x, angles.y) & ~mask;
        mask |= bits;
        float square = distance * distance / (radius * radius);
        occluded += float(bitCount(bits)) * pow(max(1.0 - square, 1e-6), attenuation);
    }
    // The mean of the weights of all slices.
    float all_slices = 0.5 * PI * cone_sine * cone_sine / range;
    raw_occlusion = max(1.0 - weight * occluded / (BITS * all_slices), 0.0);
}
