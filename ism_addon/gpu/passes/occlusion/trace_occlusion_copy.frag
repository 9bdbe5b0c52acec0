// Distances of other tiles or for them.
uniform sampler2D distances;
out float occlusion_distance;

void main() { occlusion_distance = fetch(distances, ivec2(gl_FragCoord.xy)).x; }
