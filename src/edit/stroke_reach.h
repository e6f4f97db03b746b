// How alike pixels and strokes are; checks and masks that both propagations share. Private to edit.
#pragma once

#include <cstddef>
#include <vector>

#include "edit/propagate.h"

namespace parian {

// Throws Error as propagate says; contract checks on indices.
void check_strokes(const Features& features, const std::vector<StrokePixel>& pixels, int strokes);

// Moves indicators into [0, 1] and counts those that were outside by more than rounding.
void clamp_indicators(Propagation& propagation);

// Up to reach_samples pixels of each stroke, evenly along its list.
inline constexpr std::size_t reach_samples = 32;
struct StrokeReach {
  std::vector<std::vector<float>> points;   // [stroke]: [sample][dim]
  std::vector<std::vector<float>> offsets;  // [stroke]: -ln of the sample's weight, at most 1
};
StrokeReach sample_strokes(const Features& features, const std::vector<StrokePixel>& pixels,
                           int strokes);

// z = max over the stroke's samples of min(w, 1) exp(-d^2 / sigma), for pixels [begin, end).
void measure_reach(const StrokeReach& reach, const Features& features, std::size_t stroke,
                   double sigma, std::size_t begin, std::size_t end, float* z);

}  // namespace parian
