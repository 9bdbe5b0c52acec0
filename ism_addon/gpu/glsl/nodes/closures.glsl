// What a graph's shaders add up to.
struct Closures {
    vec3 diffuse;
    vec3 normal; // sum of the shaders' normals, weighted by what they reflect
};

void closure_diffuse(inout Closures closures, float weight, vec3 color, vec3 normal) {
    vec3 reflected = max(weight * color, 0.0);
    closures.diffuse += reflected;
    closures.normal += (reflected.r + reflected.g + reflected.b) * normal;
}
