// Luminance in the scene's working space, see color.py.
float luminance(vec3 color) { return dot(color, luminance_weights.rgb); }

// The square of the luminance of a grey, and more for colors, so that those of no luminance are not 0.
float squared_norm(vec3 color) { return dot(color * color, luminance_weights.rgb); }
