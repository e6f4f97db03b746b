// Single-precision products of row-major blocks on one thread, by Eigen: compiled for x86-64-v2,
// and once more with AVX2 and fused multiply-add for the processors that have them.
#pragma once

#include <cstddef>

namespace parian {

// out [rows][k] = a [rows][columns] b [columns][k]
void multiply_block(const float* a, std::size_t rows, std::size_t columns, const float* b,
                    std::size_t k, float* out);
// out [columns][k] = a^T b, a [rows][columns], b [rows][k]
void multiply_block_transposed(const float* a, std::size_t rows, std::size_t columns,
                               const float* b, std::size_t k, float* out);
// out [rows][k] = a b^T, a [rows][columns], b [k][columns]
void multiply_block_by_transposed(const float* a, std::size_t rows, std::size_t columns,
                                  const float* b, std::size_t k, float* out);

}  // namespace parian
