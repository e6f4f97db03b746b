// Built with -mavx2 -mfma. Eigen gets a name of its own, as its inline functions must not be
// merged with those of other files.
#include <cstddef>

#define Eigen eigen_avx2  // NOLINT(bugprone-reserved-identifier,readability-identifier-naming)
#define PARIAN_VARIANT products_avx2
#include "bench/reference/matrix_product.inl"
