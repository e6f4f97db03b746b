#include "bench/reference/offset_matrix.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/check.h"
#include "base/parallel.h"
#include "bench/reference/matrix_product.h"

namespace parian {
namespace {

using Matrix = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using ConstMap = Eigen::Map<const Matrix>;
using MutableMap = Eigen::Map<Matrix>;
constexpr std::size_t row_block = 128;
constexpr std::size_t partial_sums = 16;  // of a^T b

Eigen::Index index(std::size_t i) {
  return static_cast<Eigen::Index>(i);
}

// The table's offsets, then the opposites that it does not list.
std::vector<Offset> find_offsets(const TableHeader& header, Directions directions) {
  std::vector<Offset> offsets = header.offsets;
  if (header.symmetric && directions == Directions::both)
    for (const Offset d : header.offsets)
      if (d != Offset{}) offsets.push_back({-d.dx, -d.dy});
  return offsets;
}

std::vector<std::size_t> find_opposites(const std::vector<Offset>& offsets) {
  std::vector<std::size_t> opposite(offsets.size());
  for (std::size_t i = 0; i < offsets.size(); ++i) {
    const auto found =
        std::find(offsets.begin(), offsets.end(), Offset{-offsets[i].dx, -offsets[i].dy});
    PARIAN_CHECK(found != offsets.end());
    opposite[i] = static_cast<std::size_t>(found - offsets.begin());
  }
  return opposite;
}

// A column's slice of the table, and how far behind x its value is stored.
struct Column {
  const float* slice = nullptr;
  std::ptrdiff_t shift = 0;
  PixelRange range;
};

std::vector<Column> find_columns(const BssrdfTable& table, int channel,
                                 const std::vector<Offset>& offsets) {
  const TableHeader& header = table.header;
  std::vector<Column> columns;
  for (std::size_t i = 0; i < offsets.size(); ++i) {
    const Offset d = offsets[i];
    Column column{.range = pairs_in_grid(header, d)};
    if (i < header.offsets.size()) {
      column.slice = slice_of(table, channel, static_cast<int>(i));
    } else {  // R(x, x + d) = R(x + d, x), listed at x + d with -d
      column.slice = slice_of(table, channel, find_offset(header, {-d.dx, -d.dy}));
      column.shift = static_cast<std::ptrdiff_t>(d.dy) * header.width + d.dx;
    }
    columns.push_back(column);
  }
  return columns;
}

// Row x of R', NaN where there is no value.
void gather_row(const std::vector<Column>& columns, int x, int y, std::ptrdiff_t at, float* row) {
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const Column& c = columns[i];
    const bool inside = x >= c.range.x0 && x < c.range.x1 && y >= c.range.y0 && y < c.range.y1;
    row[i] = inside ? c.slice[at + c.shift] : std::numeric_limits<float>::quiet_NaN();
  }
}

void find_missing(OffsetMatrix& matrix) {
  const std::size_t columns = matrix.columns();
  matrix.missing_begin.assign(matrix.rows + 1, 0);
  for (std::size_t x = 0; x < matrix.rows; ++x) {
    const float* row = &matrix.values[x * columns];
    for (std::size_t i = 0; i < columns; ++i)
      if (std::isnan(row[i])) matrix.missing_column.push_back(static_cast<std::uint32_t>(i));
    matrix.missing_begin[x + 1] = matrix.missing_column.size();
  }
}

std::vector<double> column_means(const OffsetMatrix& matrix) {
  std::vector<double> sum(matrix.columns(), 0.0), count(matrix.columns(), 0.0);
  for (std::size_t x = 0; x < matrix.rows; ++x) {
    const float* row = &matrix.values[x * matrix.columns()];
    for (std::size_t i = 0; i < matrix.columns(); ++i) {
      if (std::isnan(row[i])) continue;
      sum[i] += static_cast<double>(row[i]);
      count[i] += 1;
    }
  }
  for (std::size_t i = 0; i < sum.size(); ++i) sum[i] = count[i] > 0 ? sum[i] / count[i] : 0;
  return sum;
}

void guess_missing(OffsetMatrix& matrix) {
  const std::vector<double> mean = column_means(matrix);
  parallel_for_blocks(matrix.rows, row_block, [&](std::size_t begin, std::size_t end) {
    for (std::size_t x = begin; x < end; ++x) {
      float* row = &matrix.values[x * matrix.columns()];
      double own = 0, usual = 0;
      for (std::size_t i = 0; i < matrix.columns(); ++i)
        if (!std::isnan(row[i])) {
          own += static_cast<double>(row[i]);
          usual += mean[i];
        }
      const double ratio = usual > 0 ? own / usual : 1;
      for (std::size_t m = matrix.missing_begin[x]; m < matrix.missing_begin[x + 1]; ++m)
        row[matrix.missing_column[m]] = static_cast<float>(ratio * mean[matrix.missing_column[m]]);
    }
  });
}

float dot(const float* a, const float* b, std::size_t count) {
  return Eigen::Map<const Eigen::VectorXf>(a, index(count))
      .dot(Eigen::Map<const Eigen::VectorXf>(b, index(count)));
}

class FactorSource : public SliceSource {
 public:
  FactorSource(TableHeader header, std::vector<Factors> channels, bool symmetrise, std::string name)
      : header_(std::move(header)),
        channels_(std::move(channels)),
        symmetrise_(symmetrise),
        name_(std::move(name)) {
    if (symmetrise_) opposite_ = find_opposites(find_offsets(header_, Directions::both));
  }
  const TableHeader& header() const override { return header_; }
  std::string name() const override { return name_; }
  void read_slice(int channel, int offset_index, float* slice) const override {
    const Factors& factors = channels_[static_cast<std::size_t>(channel)];
    const auto column = static_cast<std::size_t>(offset_index);
    const Offset d = header_.offsets[column];
    const PixelRange range = pairs_in_grid(header_, d);
    const std::ptrdiff_t shift = static_cast<std::ptrdiff_t>(d.dy) * header_.width + d.dx;
    const float* there = &factors.right[column * factors.rank];
    const float* back = symmetrise_ ? &factors.right[opposite_[column] * factors.rank] : nullptr;
    std::fill_n(slice, header_.pixels(), std::numeric_limits<float>::quiet_NaN());
    for (int y = range.y0; y < range.y1; ++y)
      for (int x = range.x0; x < range.x1; ++x) {
        const std::ptrdiff_t at = static_cast<std::ptrdiff_t>(y) * header_.width + x;
        const float forth = eval(factors, at, there);
        slice[at] = symmetrise_ ? 0.5f * (forth + eval(factors, at + shift, back)) : forth;
      }
  }

 private:
  static float eval(const Factors& factors, std::ptrdiff_t x, const float* right) {
    const float* left = &factors.left[static_cast<std::size_t>(x) * factors.rank];
    return std::max(0.0f, dot(left, right, factors.rank));
  }

  TableHeader header_;
  std::vector<Factors> channels_;
  bool symmetrise_;
  std::string name_;
  std::vector<std::size_t> opposite_;
};

}  // namespace

OffsetMatrix make_offset_matrix(const BssrdfTable& table, int channel, Directions directions) {
  const TableHeader& header = table.header;
  OffsetMatrix matrix;
  matrix.rows = header.pixels();
  matrix.offsets = find_offsets(header, directions);
  matrix.values.resize(matrix.rows * matrix.columns());
  const std::vector<Column> columns = find_columns(table, channel, matrix.offsets);
  parallel_for(static_cast<std::size_t>(header.height), [&](std::size_t y) {
    for (int x = 0; x < header.width; ++x) {
      const std::size_t at =
          y * static_cast<std::size_t>(header.width) + static_cast<std::size_t>(x);
      gather_row(columns, x, static_cast<int>(y), static_cast<std::ptrdiff_t>(at),
                 &matrix.values[at * matrix.columns()]);
    }
  });
  find_missing(matrix);
  guess_missing(matrix);
  return matrix;
}

double fill_missing(OffsetMatrix& matrix, const Factors& model) {
  const std::size_t columns = matrix.columns();
  return parallel_sum(matrix.rows, row_block, [&](std::size_t begin, std::size_t end) {
    double sum = 0;
    for (std::size_t x = begin; x < end; ++x) {
      float* row = &matrix.values[x * columns];
      for (std::size_t m = matrix.missing_begin[x]; m < matrix.missing_begin[x + 1]; ++m) {
        const std::size_t column = matrix.missing_column[m];
        row[column] =
            dot(&model.left[x * model.rank], &model.right[column * model.rank], model.rank);
      }
      sum += static_cast<double>(dot(row, row, columns));
    }
    return sum;
  });
}

double measured_error2(const OffsetMatrix& matrix, const Factors& model) {
  const std::size_t columns = matrix.columns();
  return parallel_sum(matrix.rows, row_block, [&](std::size_t begin, std::size_t end) {
    double sum = 0;
    for (std::size_t x = begin; x < end; ++x) {
      std::size_t m = matrix.missing_begin[x];
      for (std::size_t i = 0; i < columns; ++i) {
        if (m < matrix.missing_begin[x + 1] && matrix.missing_column[m] == i) {
          ++m;
          continue;
        }
        const double error = static_cast<double>(
            matrix.values[x * columns + i] -
            dot(&model.left[x * model.rank], &model.right[i * model.rank], model.rank));
        sum += error * error;
      }
    }
    return sum;
  });
}

void multiply(const float* a, std::size_t rows, std::size_t columns, const float* b, std::size_t k,
              float* out) {
  parallel_for_blocks(rows, row_block, [&](std::size_t begin, std::size_t end) {
    multiply_block(a + begin * columns, end - begin, columns, b, k, out + begin * k);
  });
}

void multiply_transposed(const float* a, std::size_t rows, std::size_t columns, const float* b,
                         std::size_t k, float* out) {
  const std::size_t block = (rows + partial_sums - 1) / partial_sums;
  std::vector<Matrix> partial(partial_sums);
  parallel_for_blocks(rows, block, [&](std::size_t begin, std::size_t end) {
    Matrix& part = partial[begin / block];
    part.resize(index(columns), index(k));
    multiply_block_transposed(a + begin * columns, end - begin, columns, b + begin * k, k,
                              part.data());
  });
  MutableMap sum(out, index(columns), index(k));
  sum.setZero();
  for (const Matrix& part : partial)
    if (part.size() > 0) sum += part;
}

std::vector<double> make_gram(const float* a, std::size_t rows, std::size_t k) {
  const std::size_t block = (rows + partial_sums - 1) / partial_sums;
  std::vector<Eigen::MatrixXd> partial(partial_sums);
  parallel_for_blocks(rows, block, [&](std::size_t begin, std::size_t end) {
    const Eigen::MatrixXd part =
        ConstMap(a + begin * k, index(end - begin), index(k)).cast<double>();
    partial[begin / block].noalias() = part.transpose() * part;
  });
  std::vector<double> gram(k * k, 0.0);
  for (const Eigen::MatrixXd& part : partial)
    if (part.size() > 0) Eigen::Map<Eigen::MatrixXd>(gram.data(), index(k), index(k)) += part;
  return gram;
}

std::unique_ptr<SliceSource> make_factor_slices(const TableHeader& like,
                                                std::vector<Factors> channels, bool symmetrise,
                                                std::string name) {
  PARIAN_CHECK_EQ(channels.size(), static_cast<std::size_t>(like.channels));
  return std::make_unique<FactorSource>(like, std::move(channels), symmetrise, std::move(name));
}

}  // namespace parian
