// Which of the 3x3 pixels around a pixel has the prediction of its surface, or of the most similar one, as an index.
const int NEIGHBOURHOOD = 9;

// Index 0 is the pixel itself.
ivec2 neighbour(ivec2 at, int index) {
    return clamp(at + ivec2((index + 4) % 3 - 1, (index + 4) % 9 / 3 - 1), ivec2(0), last_pixel());
}

struct PredictedPixel { ivec2 at; bool similar; };

// From 1 on, indices of similar pixels; then, of pixels that are not similar enough. 0: there is no prediction.
float pack_predicted_pixel(int index, bool similar) {
    return float(1 + index + (similar ? 0 : NEIGHBOURHOOD)) / 255.0;
}

PredictedPixel predicted_pixel(sampler2D packed_pixels, ivec2 at) {
    int value = int(round(255.0 * fetch(packed_pixels, min(at, textureSize(packed_pixels, 0) - 1)).x));
    int index = max(value - 1, 0) % NEIGHBOURHOOD;
    return PredictedPixel(neighbour(at, index), value > 0 && value <= NEIGHBOURHOOD);
}
