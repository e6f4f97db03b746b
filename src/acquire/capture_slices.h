// From what leaves at each pixel under each dot frame to a table: units, neighbours' tails, the
// middle, both directions, noise.
#pragma once

#include <cstddef>
#include <vector>

#include "acquire/capture_meta.h"
#include "material/bssrdf_table.h"

namespace parian {

// Values [shift j * lattice + i][channel][y][x] of dot frame (i, j) on the table's grid.
struct DotResponses {
  std::vector<float> value;
};
inline std::size_t response_index(const CaptureMeta& meta, int i, int j, int channel) {
  return (static_cast<std::size_t>(j) * static_cast<std::size_t>(meta.lattice_px) +
          static_cast<std::size_t>(i)) *
             static_cast<std::size_t>(meta.channels) +
         static_cast<std::size_t>(channel);
}

// Exitance to R in 1/mm^2. The standard shows V E rho / pi at each pixel (V: vignetting, E:
// irradiance), a dot of power E pitch^2 at y shows V(x) E(y) R(x, y) pitch^2 / pi at x. Divided by
// sqrt(ref(x) ref(y)) the two directions of a pair differ by q(x) / q(y), q = V / E, and their mean
// by a factor cosh(ln(q(x) / q(y)) / 2), as near to 1 as neighbours are alike. `reference` is
// [channel][y][x].
void normalise_responses(const CaptureMeta& meta, const std::vector<float>& reference,
                         DotResponses& responses);

// Takes away what other dots of a frame than the nearest one add: T(r) a(x) a(y), where T is the
// mean profile between the dots and a(x) how pixel x differs from it. Returns the part of all light
// that was taken away.
double remove_tails(const CaptureMeta& meta, DotResponses& responses);

// All offsets of the disc, both directions: element x is R where light leaves at x and enters at
// x + d. Header: Boundary::included, Sampling::area.
BssrdfTable make_raw_table(const CaptureMeta& meta, const DotResponses& responses);

// Within centre_px ln R is continued from the rings beyond, linear in r, for every pixel by itself;
// specular light and remains of the blur lie there. Returns the number of offsets replaced.
int replace_centre(const CaptureMeta& meta, BssrdfTable& raw);

// The mean of both directions; the one that is there where the other is NaN.
BssrdfTable symmetrise(const BssrdfTable& raw);

// The directions of a pair are independent: the variance of their mean is E[(R - R^T)^2] / 4.
// Fitted as floor^2 + gain R + (relative R)^2 over bins of R, none below 0; the last term is what
// is systematic (asymmetry) and stays out of the table.
struct NoiseModel {
  double floor = 0, gain = 0, relative = 0;
};
NoiseModel fit_noise_model(const BssrdfTable& raw, int channel);

}  // namespace parian
