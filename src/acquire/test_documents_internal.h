// Descriptions made by code for the tests of this module.
#pragma once

#include "base/test_documents.h"

namespace parian {

// 24 x 20 pixels of 0.25 mm, radius 5, marble squares.
inline Document chessboard_description() {
  return object({{"name", "board"},
                 {"materials", array({object({{"name", "white"}, {"material", "Marble"}}),
                                      object({{"name", "dark"},
                                              {"sigma_a", array({0.3, 0.2, 0.1})},
                                              {"sigma_s_prime", array({1.0, 1.1, 1.2})},
                                              {"scale", 0.5}})})},
                 {"layout", object({{"kind", "chessboard"}, {"tile_mm", 1.5}})},
                 {"pitch_mm", 0.25},
                 {"size", array({24, 20})},
                 {"radius_px", 5},
                 {"seed", 3}});
}

inline Document homogeneous_description(const char* material) {
  Document document = chessboard_description();
  set(document, "materials", array({object({{"name", "all"}, {"material", material}})}));
  set(document, "layout", object({{"kind", "uniform"}}));
  return document;
}

}  // namespace parian
