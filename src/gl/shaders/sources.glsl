// Emitters of a level: single samples (level 0), or groups of four of the level before. Sample i
// lies at (i % width, i / width).
ivec2 source_texel(int index, int width) { return ivec2(index % width, index / width); }
