flat in float sample_index; // among the samples of the tile
