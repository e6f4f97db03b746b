// Synthetic noise for tables.
#pragma once

#include <cstdint>

#include "material/bssrdf_table.h"

namespace parian {

// Photon counts of `gain` each, then normal noise of `floor`; the header says so.
BssrdfTable add_noise(const BssrdfTable& table, double gain, double floor, std::uint64_t seed);

// The gain when `photons` enter per pixel.
double photon_gain(const BssrdfTable& table, double photons);

}  // namespace parian
