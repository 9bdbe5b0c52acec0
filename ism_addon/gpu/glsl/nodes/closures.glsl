// What a graph's shaders add up to.
struct Closures {
    vec3 diffuse;
};

void closure_diffuse(inout Closures closures, float weight, vec3 color) {
    closures.diffuse += max(weight * color, 0.0);
}
