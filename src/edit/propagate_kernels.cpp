// Four strokes at a time: each node's lanes fill a vector register.
#include "edit/propagate_kernels.h"

#include <cstring>

#include "base/hot.h"

namespace parian {
namespace {

// GCC's and Clang's vectors: element by element, the same bits for every instruction set.
using Float4 = float __attribute__((vector_size(16)));
using Double4 = double __attribute__((vector_size(32)));

}  // namespace

PARIAN_HOT void multiply_rows(const GraphMatrix& matrix, const float* PARIAN_RESTRICT x,
                              float* PARIAN_RESTRICT y, std::size_t begin, std::size_t end,
                              double* PARIAN_RESTRICT dot) {
  const std::size_t* first = matrix.first;
  const std::uint32_t* to = matrix.to;
  const float* weight = matrix.weight;
  Double4 total = {};
  for (std::size_t i = begin; i < end; ++i) {
    Float4 even = {}, odd = {}, a, b;
    std::size_t e = first[i];
    const std::size_t last = first[i + 1];
    for (; e + 1 < last; e += 2) {
      std::memcpy(&a, x + lanes * to[e], sizeof a);
      std::memcpy(&b, x + lanes * to[e + 1], sizeof b);
      even += weight[e] * a;
      odd += weight[e + 1] * b;
    }
    if (e < last) {
      std::memcpy(&a, x + lanes * to[e], sizeof a);
      even += weight[e] * a;
    }
    Float4 mine;
    std::memcpy(&mine, x + lanes * i, sizeof mine);
    const Float4 value = matrix.diagonal[i] * mine - (even + odd);
    std::memcpy(y + lanes * i, &value, sizeof value);
    total += __builtin_convertvector(value, Double4) * __builtin_convertvector(mine, Double4);
  }
  std::memcpy(dot, &total, sizeof total);
}

PARIAN_HOT void step_rows(const float* inverse_diagonal, const float* alpha,
                          const float* PARIAN_RESTRICT p, const float* PARIAN_RESTRICT q,
                          float* PARIAN_RESTRICT x, float* PARIAN_RESTRICT r, std::size_t begin,
                          std::size_t end, double* squares, double* scaled, double* sum) {
  Double4 rr = {}, rz = {}, total = {};
  Float4 step;
  std::memcpy(&step, alpha, sizeof step);
  for (std::size_t i = begin; i < end; ++i) {
    Float4 pi, qi, xi, ri;
    std::memcpy(&pi, p + lanes * i, sizeof pi);
    std::memcpy(&qi, q + lanes * i, sizeof qi);
    std::memcpy(&xi, x + lanes * i, sizeof xi);
    std::memcpy(&ri, r + lanes * i, sizeof ri);
    xi += step * pi;
    ri -= step * qi;
    std::memcpy(x + lanes * i, &xi, sizeof xi);
    std::memcpy(r + lanes * i, &ri, sizeof ri);
    const Double4 value = __builtin_convertvector(ri, Double4);
    const Double4 square = value * value;
    rr += square;
    rz += square * static_cast<double>(inverse_diagonal[i]);
    total += value;
  }
  std::memcpy(squares, &rr, sizeof rr);
  std::memcpy(scaled, &rz, sizeof rz);
  std::memcpy(sum, &total, sizeof total);
}

PARIAN_HOT void turn_rows(const float* inverse_diagonal, const float* coarse, const float* beta,
                          const float* PARIAN_RESTRICT r, float* PARIAN_RESTRICT p,
                          std::size_t begin, std::size_t end) {
  Float4 add, factor, pi, ri;
  std::memcpy(&add, coarse, sizeof add);
  std::memcpy(&factor, beta, sizeof factor);
  for (std::size_t i = begin; i < end; ++i) {
    std::memcpy(&pi, p + lanes * i, sizeof pi);
    std::memcpy(&ri, r + lanes * i, sizeof ri);
    pi = ri * inverse_diagonal[i] + add + factor * pi;
    std::memcpy(p + lanes * i, &pi, sizeof pi);
  }
}

}  // namespace parian
