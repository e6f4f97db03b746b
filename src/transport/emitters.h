// What light comes from in a gather: samples, and nodes that stand for many of them. Both
// contribute
//
//   exp(h_o(r) + L(r) + ln flux),  L piecewise linear over the knots,  zero beyond the support
//
// to a target o at distance r: for a sample L = h_i, for a node L = ln of its moments.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/aligned.h"
#include "material/profile_field.h"
#include "transport/gather.h"
#include "transport/knot_lookup.h"

namespace parian {

// Logarithm of no light at all: e^ of it is 0, and sums of a few stay finite.
inline constexpr float log_of_nothing = -1000;

struct Emitters {
  std::array<std::vector<float>, 3> position;  // x, y, z in mm
  std::array<std::vector<float>, 3> log_flux;  // per channel
  std::array<std::vector<float>, 3> support;   // per channel, mm; a node's largest
  // A node ends gradually, as its samples do one after another: half of it is left at its support,
  // over this distance in mm. 0 for samples.
  std::vector<float> edge_width;
  std::vector<float> spread;  // a quarter of a node's mean squared extent in mm^2, 0 for samples
  std::vector<std::uint32_t> row;  // index of its row in `rows`
  AlignedVector<float> rows;       // [row][knot][channel]
  std::size_t row_size = 0;

  std::size_t size() const { return row.size(); }
};

struct EmitterView {
  const float* x;
  const float* y;
  const float* z;
  const float* log_flux[3];
  const float* support[3];
  const float* edge_width;
  const float* spread;
  const std::uint32_t* row;
  const float* rows;
  std::size_t row_size;
};
EmitterView view(const Emitters& emitters);

void resize(Emitters& emitters, std::size_t count);

// Sets emitters [0, sources) to the sources in the order given (indices into sources.points). One
// row for all where the field is homogeneous.
void set_samples(Emitters& emitters, const ProfileField& field, const GatherSources& sources,
                 const std::vector<std::uint32_t>& order);

}  // namespace parian
