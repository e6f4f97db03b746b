// Vectorised steps of the sparse solver, for a range of nodes. Vectors are
// [node][lane], one lane per stroke. Private to edit.
#pragma once

#include <cstddef>
#include <cstdint>

namespace parian {

inline constexpr std::size_t lanes = 4;

// The matrix: diagonal[i] on the diagonal, -weight[e] elsewhere.
struct GraphMatrix {
  const std::size_t* first = nullptr;
  const std::uint32_t* to = nullptr;
  const float* weight = nullptr;
  const float* diagonal = nullptr;
};

// y = M x for nodes [begin, end); returns x . y per lane.
void multiply_rows(const GraphMatrix& matrix, const float* x, float* y, std::size_t begin,
                   std::size_t end, double* dot);

// x += alpha p, r -= alpha q for nodes [begin, end). Returns per lane |r|^2, r . r / diagonal and
// the sum of r.
void step_rows(const float* inverse_diagonal, const float* alpha, const float* p, const float* q,
               float* x, float* r, std::size_t begin, std::size_t end, double* squares,
               double* scaled, double* sum);

// p = r / diagonal + coarse + beta p for nodes [begin, end).
void turn_rows(const float* inverse_diagonal, const float* coarse, const float* beta,
               const float* r, float* p, std::size_t begin, std::size_t end);

}  // namespace parian
