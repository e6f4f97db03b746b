// The table of one channel as the matrix R'(x, d) = R(x, x + d) that factorisations work on (Peers
// et al. 2006: the diagonal of R becomes a column), and the slices of a factored one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "base/aligned.h"
#include "material/bssrdf_table.h"

namespace parian {

// Which columns stand for a symmetric table: its own offsets d, each pair once, so that models are
// symmetric by construction; or also -d, each pair twice. Other tables list both anyway.
enum class Directions { listed, both };

struct OffsetMatrix {
  std::size_t rows = 0;         // N pixels
  std::vector<Offset> offsets;  // D columns, the table's own first
  AlignedVector<float> values;  // [pixel][offset]; where missing, a guess that methods may replace
  std::vector<std::size_t> missing_begin;     // [pixel + 1] into
  std::vector<std::uint32_t> missing_column;  // the columns of a pixel without a value, ascending

  std::size_t columns() const { return offsets.size(); }
};

// R' ~ left right^T.
struct Factors {
  std::size_t rank = 0;
  AlignedVector<float> left;   // [pixel][rank]
  AlignedVector<float> right;  // [offset][rank]
};

// Missing values are guessed as the mean of their column, times the pixel's ratio to the means.
OffsetMatrix make_offset_matrix(const BssrdfTable& table, int channel, Directions directions);

// Replaces guesses by the model's values, so that a method for complete matrices that lowers
// |R' - model|^2 also lowers it over the measured values alone (expectation maximisation). Returns
// the sum of squares of all values.
double fill_missing(OffsetMatrix& matrix, const Factors& model);

// |R' - left right^T|^2 over the measured values.
double measured_error2(const OffsetMatrix& matrix, const Factors& model);

// out [rows][k] = a [rows][columns] b [columns][k]. All matrices by rows.
void multiply(const float* a, std::size_t rows, std::size_t columns, const float* b, std::size_t k,
              float* out);
// out [columns][k] = a^T b, b [rows][k]: summed over blocks of rows in their order.
void multiply_transposed(const float* a, std::size_t rows, std::size_t columns, const float* b,
                         std::size_t k, float* out);
// The same in double precision: [k][k] = a^T a of a tall matrix.
std::vector<double> make_gram(const float* a, std::size_t rows, std::size_t k);

// Slices of one factored matrix per channel, with columns for at least the table's own offsets;
// what is negative becomes 0. symmetrise (needs columns for both directions): the mean of R~(x, x +
// d) and R~(x + d, x), the orthogonal projection onto symmetric tables.
std::unique_ptr<SliceSource> make_factor_slices(const TableHeader& like,
                                                std::vector<Factors> channels, bool symmetrise,
                                                std::string name);

}  // namespace parian
