// The inner loops of an update: dot products of coefficients with transport kept as half floats.
#pragma once

#include <cstddef>
#include <cstdint>

namespace parian {

// Per block of 8 places, out[block][3][8] += sum_j coefficient[j][channel] T[block][j][channel][8].
void add_multiple(const std::uint16_t* half, std::size_t blocks, std::size_t functions,
                  const float* coefficient, float* out);
// out[block][3][8] += (S_0 - 3 g w_o' . S_123) with S = sum_j coefficient[j][channel] S_j; view as
// in TransportView.
void add_single(const std::uint16_t* half, std::size_t blocks, std::size_t functions,
                const float* coefficient, const float* three_g, const float* view, float* out);
// radiance[block][lane][channel] = F_t out
void finish_radiance(const float* out, const float* view, std::size_t blocks, float* radiance);

}  // namespace parian
