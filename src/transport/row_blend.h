// Profiles as rows of a field, half_log[knot][channel], and mixtures of two of them by property
// (SubEdit, section 7.1) in closed form: what blend_profiles does, for hundreds of thousands of
// points and on fixed knots.
#pragma once

#include <array>
#include <vector>

#include "material/properties.h"

namespace parian {

// Knots of rows, and what integrals and lookups need of them.
struct RowKnots {
  std::vector<float> knots_mm;
  std::vector<float> start_mm, length_mm;  // of segments, repeated for the three channels
  std::vector<float> next_mm;              // the next knot; infinity for the last two
  std::vector<float> inverse_length;       // of segments

  std::size_t knots() const { return knots_mm.size(); }
  std::size_t row() const { return 3 * knots_mm.size(); }
};
RowKnots make_row_knots(std::vector<float> knots_mm);

// half_log goes on beyond the support, which is at most the last knot.
struct ProfileRow {
  std::vector<float> half_log;
  std::array<float, 3> support_mm{};
};

// Of each channel: C = int P r dr over the support, and the range (Eq. 10).
struct RowProperties {
  std::array<double, 3> integral{};
  std::array<double, 3> range_mm{};
};

// What one thread works with: reuse it.
struct RowScratch {
  std::vector<float> value, exponential, term, other;
};

RowProperties measure_row(const RowKnots& knots, const ProfileRow& row, RowScratch& scratch);

// No value above the one at the knot before.
void prevent_rises(ProfileRow& row);

// Writes the mixture to `a`. Its albedo is met to float rounding, its range to the knots'
// resolution; its support lies between those of a and b. All weights 0 leave a, all 1 copy b.
// `monotone`: a and b never rise, and the mixture is made not to.
void blend_rows(const RowKnots& knots, ProfileRow& a, const ProfileRow& b,
                const PropertyWeights& weights, bool monotone, RowScratch& scratch);

}  // namespace parian
