// The bodies of matrix_product.h, in namespaces of the variant's own: `Eigen` and
// PARIAN_VARIANT are macros there, so that no template is shared between instruction sets.
#include <Eigen/Core>

namespace parian::PARIAN_VARIANT {

using Matrix = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

inline Eigen::Map<const Matrix> view(const float* values, std::size_t rows, std::size_t columns) {
  return {values, static_cast<Eigen::Index>(rows), static_cast<Eigen::Index>(columns)};
}
inline Eigen::Map<Matrix> view(float* values, std::size_t rows, std::size_t columns) {
  return {values, static_cast<Eigen::Index>(rows), static_cast<Eigen::Index>(columns)};
}

void multiply_block(const float* a, std::size_t rows, std::size_t columns, const float* b,
                    std::size_t k, float* out) {
  view(out, rows, k).noalias() = view(a, rows, columns) * view(b, columns, k);
}

void multiply_block_transposed(const float* a, std::size_t rows, std::size_t columns,
                               const float* b, std::size_t k, float* out) {
  view(out, columns, k).noalias() = view(a, rows, columns).transpose() * view(b, rows, k);
}

void multiply_block_by_transposed(const float* a, std::size_t rows, std::size_t columns,
                                  const float* b, std::size_t k, float* out) {
  view(out, rows, k).noalias() = view(a, rows, columns) * view(b, k, columns).transpose();
}

}  // namespace parian::PARIAN_VARIANT
