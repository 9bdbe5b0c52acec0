// What passes through the surfaces at points: a texel each.
#include "surfaces/shading_point.glsl"
#include "surfaces/transparency.glsl"
uniform usamplerBuffer points; // two texels each: position and triangle; normal and instance
uniform int columns;
out float passes;

void main() {
    int row = int(gl_FragCoord.y) * columns + int(gl_FragCoord.x);
    uvec4 one = texelFetch(points, 2 * row), other = texelFetch(points, 2 * row + 1);
    int triangle = int(one.w), material = fetch_triangle(triangle).material;
    passes = 0.0;
    if (!has_transparency(material)) return;
    ShadingPoint at = shading_point(triangle, int(other.w), uintBitsToFloat(one.xyz), uintBitsToFloat(other.xyz));
    passes = dot(transparency(material, at).rgb, vec3(1.0 / 3.0));
}
