// The compiled variants of the kernels, between transport_kernels.cpp and its siblings only.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(PARIAN_NO_CLONES)
#define PARIAN_TRANSPORT_HAS_F16C 1
#endif

namespace parian {

// Vectors of 8, which never cross a boundary between translation units.
inline constexpr std::size_t kernel_lanes = 8;
using Floats = float __attribute__((vector_size(32)));

}  // namespace parian

#define PARIAN_DECLARE_TRANSPORT(space)                                                           \
  namespace parian::space {                                                                       \
  void add_multiple(const std::uint16_t* half, std::size_t blocks, std::size_t functions,         \
                    const float* coefficient, float* out);                                        \
  void add_single(const std::uint16_t* half, std::size_t blocks, std::size_t functions,           \
                  const float* coefficient, const float* three_g, const float* view, float* out); \
  void finish_radiance(const float* out, const float* view, std::size_t blocks, float* radiance); \
  }

PARIAN_DECLARE_TRANSPORT(transport_baseline)
PARIAN_DECLARE_TRANSPORT(transport_f16c)
