#include "transport/transport_kernels.h"

#include "transport/half.h"
#include "transport/transport_kernels_variants.h"

#pragma GCC diagnostic ignored "-Wpsabi"

namespace {
[[gnu::always_inline]] inline void load_halves(const std::uint16_t* from, parian::Floats& to) {
  float value[8];
  for (int i = 0; i < 8; ++i) value[i] = parian::half_to_float(from[i]);
  std::memcpy(&to, value, sizeof to);
}
}  // namespace

#define PARIAN_KERNEL_SPACE transport_baseline
#include "transport/transport_kernels.inl"

namespace parian {
namespace {

#ifdef PARIAN_TRANSPORT_HAS_F16C
bool use_f16c() {
  static const bool supported =
      __builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("f16c") != 0;
  return supported;
}
#define PARIAN_TRANSPORT_CALL(function, ...) \
  (use_f16c() ? transport_f16c::function(__VA_ARGS__) : transport_baseline::function(__VA_ARGS__))
#else
#define PARIAN_TRANSPORT_CALL(function, ...) transport_baseline::function(__VA_ARGS__)
#endif

}  // namespace

void add_multiple(const std::uint16_t* half, std::size_t blocks, std::size_t functions,
                  const float* coefficient, float* out) {
  PARIAN_TRANSPORT_CALL(add_multiple, half, blocks, functions, coefficient, out);
}
void add_single(const std::uint16_t* half, std::size_t blocks, std::size_t functions,
                const float* coefficient, const float* three_g, const float* view, float* out) {
  PARIAN_TRANSPORT_CALL(add_single, half, blocks, functions, coefficient, three_g, view, out);
}
void finish_radiance(const float* out, const float* view, std::size_t blocks, float* radiance) {
  PARIAN_TRANSPORT_CALL(finish_radiance, out, view, blocks, radiance);
}

}  // namespace parian
