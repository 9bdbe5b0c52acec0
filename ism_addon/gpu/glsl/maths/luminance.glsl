// Luminance in the scene's working space, see color.py.
float luminance(vec3 color) { return dot(color, luminance_weights.rgb); }
