// What every rival compression gives back, so that judge/compare measures all methods alike.
#pragma once

#include <cstddef>
#include <memory>
#include <string>

#include "material/slices.h"

namespace parian {

struct Rival {
  std::string name;
  std::size_t bytes = 0;  // what the method's own file would take, headers apart
  double seconds = 0;     // from the table in memory to the model
  // R_d of the model at the table's offsets; owns the model. Null: the method has no model of as
  // few bytes as asked for, and `bytes` may say how many it needs.
  std::unique_ptr<SliceSource> slices;
};

}  // namespace parian
