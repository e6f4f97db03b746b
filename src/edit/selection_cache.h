// What selections keep between runs: masks, and the neighbour graphs that strokes propagate along,
// which change only with the profiles.
#pragma once

#include <memory>
#include <vector>

#include "edit/features.h"
#include "edit/neighbours.h"
#include "edit/recipe.h"

namespace parian {

struct Appearance {
  std::shared_ptr<const Features> features;
  std::shared_ptr<const NeighbourGraph> graph;  // null until a sparse propagation needs it
};

struct SelectionCache {
  struct KnownMask {
    Document source;
    EditState frame, input;
    bool uses_input = false;
    std::shared_ptr<const Mask> mask;
  };
  struct KnownAppearance {
    EditState state;
    Document settings;  // the distance, the table, the number of neighbours
    Appearance appearance;
  };
  std::vector<KnownMask> masks;  // the most recent last
  std::vector<KnownAppearance> appearances;
};

}  // namespace parian
