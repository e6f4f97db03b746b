#include <gtest/gtest.h>

#include <Eigen/SVD>
#include <cmath>
#include <functional>

#include "base/parallel.h"
#include "base/random.h"
#include "bench/reference/linsss.h"
#include "bench/reference/lsp_clusters.h"
#include "bench/reference/peers_2006.h"
#include "bench/reference/test_values.h"
#include "bench/reference/truncated_svd.h"
#include "bench/reference/tucker.h"
#include "fit/fit.h"
#include "fit/test_tables.h"
#include "material/material.h"

namespace parian {
namespace {

// left right^T with about `missing` of the entries absent and zero.
OffsetMatrix make_planted(const Factors& planted, std::size_t rows, double missing) {
  const std::size_t columns = planted.right.size() / planted.rank;
  OffsetMatrix matrix;
  matrix.rows = rows;
  for (std::size_t i = 0; i < columns; ++i) matrix.offsets.push_back({static_cast<int>(i), 0});
  matrix.values.resize(rows * columns);
  matrix.missing_begin.assign(1, 0);
  for (std::size_t x = 0; x < rows; ++x) {
    for (std::size_t i = 0; i < columns; ++i) {
      float& value = matrix.values[x * columns + i];
      value = 0;
      if (hash_to_uniform(hash_u64(x, i)) < missing) {
        matrix.missing_column.push_back(static_cast<std::uint32_t>(i));
        continue;
      }
      for (std::size_t k = 0; k < planted.rank; ++k)
        value += planted.left[x * planted.rank + k] * planted.right[i * planted.rank + k];
    }
    matrix.missing_begin.push_back(matrix.missing_column.size());
  }
  return matrix;
}

double squares(const AlignedVector<float>& values) {
  double sum = 0;
  for (const float value : values) sum += static_cast<double>(value) * static_cast<double>(value);
  return sum;
}

// Sum over ordered pairs of a symmetric table.
double model_error2(const BssrdfTable& table, const SliceSource& model) {
  std::vector<float> slice(table.header.pixels());
  double sum = 0;
  for (int c = 0; c < table.header.channels; ++c)
    for (std::size_t i = 0; i < table.header.offsets.size(); ++i) {
      model.read_slice(c, static_cast<int>(i), slice.data());
      const float* data = slice_of(table, c, static_cast<int>(i));
      for (std::size_t x = 0; x < slice.size(); ++x) {
        if (std::isnan(data[x])) continue;
        const double error = static_cast<double>(slice[x]) - static_cast<double>(data[x]);
        sum += error * error * pair_count(table.header, table.header.offsets[i]);
      }
    }
  return sum;
}

double table_energy(const BssrdfTable& table) {
  double sum = 0;
  for (int c = 0; c < table.header.channels; ++c)
    for (std::size_t i = 0; i < table.header.offsets.size(); ++i)
      for (std::size_t x = 0; x < table.header.pixels(); ++x) {
        const auto r = static_cast<double>(slice_of(table, c, static_cast<int>(i))[x]);
        if (!std::isnan(r)) sum += r * r * pair_count(table.header, table.header.offsets[i]);
      }
  return sum;
}

TEST(OffsetMatrix, HoldsEachPairInBothDirections) {
  BssrdfTable table = make_test_table(9, 7, 3);
  remove_pairs(table, 0.1, 5);
  const OffsetMatrix matrix = make_offset_matrix(table, 0, Directions::both);
  ASSERT_EQ(matrix.columns(), 2 * table.header.offsets.size() - 1);
  std::size_t present = 0;
  for (std::size_t x = 0; x < matrix.rows; ++x) {
    std::size_t m = matrix.missing_begin[x];
    for (std::size_t i = 0; i < matrix.columns(); ++i) {
      const Offset d = matrix.offsets[i];
      const int px = static_cast<int>(x) % 9, py = static_cast<int>(x) / 9;
      const bool inside = px + d.dx >= 0 && px + d.dx < 9 && py + d.dy >= 0 && py + d.dy < 7;
      const int own = find_offset(table.header, d);
      const float value =
          !inside ? NAN
          : own >= 0
              ? slice_of(table, 0, own)[x]
              : slice_of(table, 0,
                         find_offset(table.header, {-d.dx, -d.dy}))[(py + d.dy) * 9 + px + d.dx];
      const bool missing = m < matrix.missing_begin[x + 1] && matrix.missing_column[m] == i;
      m += missing ? 1 : 0;
      ASSERT_EQ(missing, std::isnan(value));
      if (!missing) {
        EXPECT_EQ(matrix.values[x * matrix.columns() + i], value);
        ++present;
      } else {
        EXPECT_GT(matrix.values[x * matrix.columns() + i], 0);  // a guess
      }
    }
  }
  EXPECT_GT(present, matrix.rows);
  EXPECT_EQ(make_offset_matrix(table, 0, Directions::listed).columns(),
            table.header.offsets.size());
}

TEST(OffsetMatrix, ProductsMatchEigen) {
  using Matrix = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const auto a = random_values(301 * 17, 1), b = random_values(17 * 5, 2),
             c = random_values(301 * 5, 3);
  const Eigen::Map<const Matrix> ma(a.data(), 301, 17), mb(b.data(), 17, 5), mc(c.data(), 301, 5);
  AlignedVector<float> product(301 * 5), transposed(17 * 5);
  multiply(a.data(), 301, 17, b.data(), 5, product.data());
  multiply_transposed(a.data(), 301, 17, c.data(), 5, transposed.data());
  EXPECT_LT((Eigen::Map<const Matrix>(product.data(), 301, 5) - ma * mb).cwiseAbs().maxCoeff(),
            1e-5);
  EXPECT_LT((Eigen::Map<const Matrix>(transposed.data(), 17, 5) - ma.transpose() * mc)
                .cwiseAbs()
                .maxCoeff(),
            1e-3);
  const std::vector<double> gram = make_gram(a.data(), 301, 17);
  EXPECT_NEAR(gram[3 * 17 + 8], ma.col(3).cast<double>().dot(ma.col(8).cast<double>()), 1e-9);
}

TEST(TruncatedSvd, EqualsEigenOnACompleteMatrix) {
  Factors planted{
      .rank = 12, .left = random_values(60 * 12, 1), .right = random_values(20 * 12, 2)};
  OffsetMatrix matrix = make_planted(planted, 60, 0);
  const Eigen::Map<const Eigen::Matrix<float, -1, -1, Eigen::RowMajor>> map(matrix.values.data(),
                                                                            60, 20);
  const Eigen::JacobiSVD<Eigen::MatrixXd> expected(map.cast<double>());
  std::vector<double> singular;
  const Factors f = factor_svd(matrix, 4, {}, &singular);
  double rest = 0;
  for (int i = 0; i < 20; ++i)
    if (i < 4)
      EXPECT_NEAR(singular[static_cast<std::size_t>(i)], expected.singularValues()[i], 1e-4) << i;
    else
      rest += std::pow(expected.singularValues()[i], 2);
  EXPECT_NEAR(measured_error2(matrix, f), rest, 1e-3 * rest);  // Eckart and Young
}

TEST(TruncatedSvd, FillsInWhatIsMissing) {
  Factors planted{.rank = 3, .left = random_values(80 * 3, 1), .right = random_values(30 * 3, 2)};
  OffsetMatrix matrix = make_planted(planted, 80, 0.1);
  const double energy = squares(matrix.values);
  SvdParams params;
  params.extra = 0;
  params.rounds = 2;
  OffsetMatrix short_of_rounds = matrix;
  const double early =
      measured_error2(short_of_rounds, factor_svd(short_of_rounds, 3, params)) / energy;
  params.rounds = 60;
  EXPECT_LT(measured_error2(matrix, factor_svd(matrix, 3, params)) / energy, 1e-7);
  EXPECT_GT(early, 1e-4);
}

TEST(Peers2006, RecoversPlantedFactors) {
  Factors planted{.rank = 3, .left = random_values(90 * 3, 1), .right = random_values(40 * 3, 2)};
  for (float& value : planted.left) value = std::max(0.0f, value - 0.5f);
  for (float& value : planted.right) value = std::max(0.0f, value - 0.5f);
  OffsetMatrix matrix = make_planted(planted, 90, 0.1);
  const double energy = squares(matrix.values);
  PeersParams params;
  params.rank = 3;
  params.iterations = 400;
  params.tolerance = 0;
  const PeersChannel channel = factor_peers_2006(matrix, params);
  expect_not_rising(channel.objective, 1e-6);
  EXPECT_LT(measured_error2(matrix, channel.factors), 1e-5 * energy);
  EXPECT_NEAR(measured_error2(matrix, channel.factors), channel.objective.back(), 1e-5 * energy);
  for (const auto* side : {&channel.factors.left, &channel.factors.right})
    for (const float value : *side) EXPECT_GE(value, 0);
  params.rank = 1;
  EXPECT_GT(factor_peers_2006(matrix, params).objective.back(), 0.05 * energy);
}

TEST(Peers2006, OneTermIsTheHomogeneousMaterial) {
  BssrdfTable table = make_test_table(12, 10, 4);
  for (std::size_t i = 0; i < table.header.offsets.size(); ++i)
    for (std::size_t x = 0; x < table.header.pixels(); ++x) {
      float& r = slice_of(table, 0, static_cast<int>(i))[x];
      if (!std::isnan(r))
        r = static_cast<float>(std::exp(-0.5 * length_px(table.header.offsets[i])));
    }
  OffsetMatrix matrix = make_offset_matrix(table, 0, Directions::both);
  const PeersChannel channel = factor_peers_2006(matrix, {});
  for (std::size_t i = 0; i < channel.radius2.size(); ++i)
    EXPECT_NEAR(channel.mean_decay[i], std::exp(-0.5 * std::sqrt(channel.radius2[i])), 1e-6);
  std::vector<Factors> factors{channel.factors};
  EXPECT_LT(model_error2(table, *make_factor_slices(table.header, factors, true, {})),
            1e-9 * table_energy(table));
}

TEST(Peers2006, SymmetrisedIsNeverWorseOnSymmetricData) {
  const BssrdfTable table = make_test_table(16, 13, 4);
  for (const std::size_t rank : {1, 2, 5}) {
    OffsetMatrix matrix = make_offset_matrix(table, 0, Directions::both);
    PeersParams params;
    params.rank = rank;
    const PeersChannel channel = factor_peers_2006(matrix, params);
    const double plain = measured_error2(matrix, channel.factors);
    const std::vector<Factors> factors{channel.factors};
    EXPECT_LT(model_error2(table, *make_factor_slices(table.header, factors, true, {})), plain);
  }
}

TEST(Tucker, RecoversAPlantedCore) {
  const std::array<std::size_t, 3> size{11, 13, 9}, rank{2, 3, 2};
  const auto core = random_values(12, 1), y = random_values(22, 2), x = random_values(39, 3),
             d = random_values(18, 4);
  Tensor tensor{size, AlignedVector<float>(11 * 13 * 9)};
  for (std::size_t i = 0; i < tensor.values.size(); ++i) {
    double sum = 0;
    for (std::size_t k = 0; k < 12; ++k)
      sum += static_cast<double>(core[k] * y[i / 117 * 2 + k / 6] * x[i / 9 % 13 * 3 + k / 2 % 3] *
                                 d[i % 9 * 2 + k % 2]);
    tensor.values[i] = static_cast<float>(sum);
  }
  const double energy = squares(tensor.values);
  EXPECT_NEAR(factor_tucker(tensor, rank, 0).captured, energy, 1e-5 * energy);
  EXPECT_LT(factor_tucker(tensor, {1, 3, 2}, 3).captured, energy * (1 - 1e-4));
  // Sweeps go on from the truncated higher-order SVD.
  const Tensor noise{size, random_values(11 * 13 * 9, 7)};
  const TuckerModel model = factor_tucker(noise, {3, 4, 2}, 4);
  for (std::size_t i = 1; i < model.history.size(); ++i)
    EXPECT_GE(model.history[i], model.history[i - 1] * (1 - 1e-6));
  EXPECT_GT(model.captured, model.history[0]);
}

TEST(Tucker, ChoosesTheRanksThatKeepMost) {
  Tensor core{{4, 5, 3}, random_values(60, 3)};
  const std::size_t depth = 20, floats = 120;
  double energy = 0, most = 0;
  const auto rank = choose_tucker_ranks(core, depth, floats, &energy);
  EXPECT_LE(tucker_floats({4, 5, depth}, rank), floats);
  for (std::size_t a = 1; a <= 4; ++a)
    for (std::size_t b = 1; b <= 5; ++b)
      for (std::size_t c = 1; c <= 3; ++c) {
        if (tucker_floats({4, 5, depth}, {a, b, c}) > floats) continue;
        double kept = 0;
        for (std::size_t i = 0; i < 60; ++i)
          if (i / 15 < a && i / 3 % 5 < b && i % 3 < c)
            kept += std::pow(static_cast<double>(core.values[i]), 2);
        most = std::max(most, kept);
      }
  EXPECT_NEAR(energy, most, 1e-9);
  EXPECT_EQ(choose_tucker_ranks(core, depth, 20, nullptr), (std::array<std::size_t, 3>{}));
}

TEST(LspClusters, AreExactWithAClusterPerDistinctRow) {
  const auto distinct = random_values(7 * 5, 1);
  std::vector<float> rows;
  for (std::size_t i = 0; i < 50; ++i)
    for (std::size_t k = 0; k < 5; ++k) rows.push_back(distinct[hash_u64(i) % 7 * 5 + k]);
  for (const std::size_t count : {7, 9}) {
    const Clusters clusters = cluster_rows(rows, 5, count, 20, 1);
    EXPECT_EQ(clusters.centre.size(), 7u * 5);
    for (std::size_t i = 0; i < rows.size(); ++i)
      EXPECT_EQ(clusters.centre[clusters.index[i / 5] * 5u + i % 5], rows[i]);
  }
  EXPECT_GT(cluster_rows(rows, 5, 6, 20, 1).objective.back(), 1e-3);
}

TEST(LspClusters, LloydNeverRises) {
  const auto values = random_values(400 * 3, 1);
  const std::vector<float> rows(values.begin(), values.end());
  expect_not_rising(cluster_rows(rows, 3, 10, 50, 1).objective, 1e-6);
}

TEST(LspClusters, AClusterPerPixelReproducesTheFit) {
  const BssrdfTable table = make_test_table(14, 12, 4, 3);
  const Material map = fit_profiles(*make_slices(table), {}).map;
  const auto fitted = make_slices(map, table.header);
  const Rival rival = compress_lsp_clusters(table, 1'000'000);
  std::vector<float> a(table.header.pixels()), b(a.size());
  for (int c = 0; c < 3; ++c)
    for (int i = 0; i < static_cast<int>(table.header.offsets.size()); ++i) {
      fitted->read_slice(c, i, a.data());
      rival.slices->read_slice(c, i, b.data());
      for (std::size_t x = 0; x < a.size(); ++x) ASSERT_TRUE(a[x] == b[x] || std::isnan(a[x]));
    }
  EXPECT_EQ(rival.bytes, 168u * (4 * 3 * 5 + 1));  // 5 knots
}

TEST(LspClusters, CountsBytesAsThePaper) {
  const ProfileMap map = make_profile_map(20, 15, 3, 1, {0, 1, 2, 3});
  EXPECT_EQ(count_clusters(map, 300), 0u);
  EXPECT_EQ(count_clusters(map, 300 + 4 * 3 * 4 * 10), 10u);
  EXPECT_EQ(count_clusters(map, 299 + 4 * 3 * 4 * 10), 9u);
  EXPECT_EQ(count_clusters(map, 600 + 48 * 256), 256u);
  EXPECT_EQ(count_clusters(map, 600 + 48 * 257), 257u);
  EXPECT_EQ(count_clusters(map, 1'000'000), 300u);
}

using Compress = std::function<Rival(const BssrdfTable&, std::size_t)>;

std::vector<Compress> all_rivals() {
  std::vector<Compress> all;
  for (auto* compress :
       {compress_lsp_clusters, compress_linsss, compress_truncated_svd, compress_tucker})
    all.emplace_back([compress](const BssrdfTable& t, std::size_t b) { return compress(t, b, 7); });
  for (const PeersForm form : {PeersForm::plain, PeersForm::symmetrised, PeersForm::half_plane})
    all.emplace_back(
        [form](const BssrdfTable& t, std::size_t b) { return compress_peers_2006(t, b, 7, form); });
  return all;
}

TEST(Rivals, KeepTheirBytesAndGainFromMore) {
  BssrdfTable table = make_test_table(18, 15, 4, 3);
  remove_pairs(table, 0.05, 3);
  const double energy = table_energy(table);
  for (const Compress& compress : all_rivals()) {
    double before = energy;
    for (const std::size_t bytes : {6'000, 15'000, 26'000}) {
      const Rival rival = compress(table, bytes);
      SCOPED_TRACE(rival.name + " " + std::to_string(bytes));
      ASSERT_TRUE(rival.slices);
      EXPECT_LE(rival.bytes, bytes);
      EXPECT_GT(rival.bytes, bytes / 2);
      const double error = model_error2(table, *rival.slices);
      EXPECT_LT(error, 1.05 * before);
      before = error;
    }
    EXPECT_LT(before, 0.01 * energy);
    EXPECT_FALSE(compress(table, 100).slices);
  }
}

TEST(Rivals, GiveTheSameBitsForAnyNumberOfThreads) {
  const BssrdfTable table = make_test_table(23, 19, 4, 3);
  for (const Compress& compress : all_rivals()) {
    std::vector<BssrdfTable> models;
    for (const int threads : {1, 2}) {
      const ThreadLimit limit(threads);
      const Rival rival = compress(table, 15'000);
      models.push_back(make_bssrdf_table(table.header));
      for (int c = 0; c < 3; ++c)
        for (int i = 0; i < static_cast<int>(table.header.offsets.size()); ++i)
          rival.slices->read_slice(c, i, slice_of(models.back(), c, i));
    }
    for (std::size_t i = 0; i < table.reflectance.size(); ++i) {
      const float value = models[0].reflectance[i];
      ASSERT_EQ(std::isnan(value), std::isnan(table.reflectance[i]));
      if (std::isnan(value)) continue;
      ASSERT_EQ(value, models[1].reflectance[i]);
      ASSERT_GE(value, 0);
    }
  }
}

}  // namespace
}  // namespace parian
