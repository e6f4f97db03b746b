// The mean profile of a capture beyond what its table holds. Internal to this folder.
#pragma once

#include <vector>

#include "acquire/capture_slices.h"

namespace parian {

// R(x, y) is about T(r) factor(x) factor(y), r in pixels.
struct TailModel {
  std::vector<double> mean;    // T at r = 0, 1, ... up to half the lattice
  double decay_per_px = 0;     // beyond; infinite where nothing is seen there
  std::vector<double> factor;  // [y][x]
};
TailModel make_tail_model(const CaptureMeta& meta, const DotResponses& responses, int channel);
double eval_tail(const TailModel& tail, double r_px);

}  // namespace parian
