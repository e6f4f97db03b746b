#include "bench/reference/matrix_product.h"

#define PARIAN_VARIANT products_baseline
#include "bench/reference/matrix_product.inl"

namespace parian {

#ifdef PARIAN_PRODUCTS_AVX2
namespace products_avx2 {
void multiply_block(const float*, std::size_t, std::size_t, const float*, std::size_t, float*);
void multiply_block_transposed(const float*, std::size_t, std::size_t, const float*, std::size_t,
                               float*);
void multiply_block_by_transposed(const float*, std::size_t, std::size_t, const float*, std::size_t,
                                  float*);
}  // namespace products_avx2

namespace {
bool has_avx2() {
  static const bool has = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  return has;
}
}  // namespace
#else
namespace products_avx2 = products_baseline;
namespace {
bool has_avx2() {
  return false;
}
}  // namespace
#endif

void multiply_block(const float* a, std::size_t rows, std::size_t columns, const float* b,
                    std::size_t k, float* out) {
  (has_avx2() ? products_avx2::multiply_block : products_baseline::multiply_block)(a, rows, columns,
                                                                                   b, k, out);
}

void multiply_block_transposed(const float* a, std::size_t rows, std::size_t columns,
                               const float* b, std::size_t k, float* out) {
  (has_avx2() ? products_avx2::multiply_block_transposed
              : products_baseline::multiply_block_transposed)(a, rows, columns, b, k, out);
}

void multiply_block_by_transposed(const float* a, std::size_t rows, std::size_t columns,
                                  const float* b, std::size_t k, float* out) {
  (has_avx2() ? products_avx2::multiply_block_by_transposed
              : products_baseline::multiply_block_by_transposed)(a, rows, columns, b, k, out);
}

}  // namespace parian
