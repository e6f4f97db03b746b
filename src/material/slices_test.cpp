#include "material/slices.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "base/test_errors.h"
#include "material/bssrdf_table.h"

namespace parian {
namespace {

TableHeader make_header() {
  TableHeader header;
  header.width = 4;
  header.height = 3;
  header.channels = 1;
  header.offsets = {{0, 0}, {1, 0}, {-1, 1}};
  return header;
}

TEST(TableHeader, EveryRuleHasItsMessage) {
  const auto message = [](const std::function<void(TableHeader&)>& spoil) {
    TableHeader header = make_header();
    spoil(header);
    return error_of([&] { check(header, "a.h5"); });
  };
  EXPECT_EQ(message([](TableHeader&) {}), "no error");
  EXPECT_EQ(message([](TableHeader& h) { h.pixel_pitch_mm = std::nan(""); }),
            "a.h5: attribute 'pixel_pitch_mm': expected a finite length > 0, found nan");
  EXPECT_EQ(message([](TableHeader& h) { h.channels = 2; }),
            "a.h5: channels: expected 1 or 3, found 2");
  EXPECT_EQ(message([](TableHeader& h) {
              h.offsets[1] = {-1, 0};
            }),
            "a.h5: offsets[1]: expected an offset of the half plane dy > 0, or dy = 0 and dx >= 0, "
            "found (-1, 0)");
  EXPECT_EQ(message([](TableHeader& h) {
              h.offsets[2] = {1, 0};
            }),
            "a.h5: offsets[2]: expected each offset once, found (1, 0) again");
  EXPECT_EQ(message([](TableHeader& h) {
              h.offsets[0] = {2, 0};
            }),
            "a.h5: offsets: expected the offset (0, 0) among them, found none");
  EXPECT_EQ(
      message([](TableHeader& h) {
        h.offsets[1] = {4, 0};
      }),
      "a.h5: offsets[1]: expected |dx| < 4 and |dy| < 3, the size of the sample, found (4, 0)");
  EXPECT_EQ(message([](TableHeader& h) { h.symmetric = false; }),
            "a.h5: offsets: expected both directions of each offset, as symmetric = 0: (1, -1), "
            "found only (-1, 1)");
  EXPECT_EQ(
      message([](TableHeader& h) { h.noise_floor = {0.1}; }),
      "a.h5: attribute 'noise_gain': expected 1 values, one per channel, as for its twin, found 0");
}

TEST(CleanSlice, RefusesInfinitiesAlwaysAndLowValuesWithoutANoiseModel) {
  TableHeader header = make_header();
  const float inf = std::numeric_limits<float>::infinity(), nan = std::nanf("");
  std::vector<float> slice(12, 1.0f);
  slice[3] = inf;  // pair (3,0)-(4,0) leaves the grid: never read
  EXPECT_EQ(clean_slice(header, "a.h5", 0, 1, slice.data()), 0u);
  EXPECT_TRUE(std::isnan(slice[3]) && std::isnan(slice[11]) && slice[0] == 1);
  slice[5] = nan;
  EXPECT_EQ(clean_slice(header, "a.h5", 0, 1, slice.data()), 0u);
  slice[6] = -0.5f;
  EXPECT_EQ(error_of([&] { clean_slice(header, "a.h5", 0, 1, slice.data()); }),
            "a.h5: reflectance[0][1][1][2] (channel, offset, y, x): expected a value > 0 or NaN, "
            "as the table has "
            "no noise model, found -0.5");
  header.noise_floor = header.noise_gain = {0.1};
  EXPECT_EQ(clean_slice(header, "a.h5", 0, 1, slice.data()), 1u);
  slice[6] = -inf;
  EXPECT_EQ(error_of([&] { clean_slice(header, "a.h5", 0, 1, slice.data()); }),
            "a.h5: reflectance[0][1][1][2] (channel, offset, y, x): expected a finite value or NaN "
            "(not measured), found -inf");
}

TEST(Slices, AreVisitedInOrderAndReadBack) {
  TableHeader header = make_header();
  header.channels = 3;
  BssrdfTable table = make_bssrdf_table(header);
  for (std::size_t i = 0; i < table.reflectance.size(); ++i)
    table.reflectance[i] = 1 + static_cast<float>(i);
  const auto source = make_slices(table);
  int expected = 0;
  for_each_slice(*source, {}, "", [&](int c, int d, const float* slice) {
    EXPECT_EQ(3 * c + d, expected++);
    if (d == 0) {
      EXPECT_EQ(slice[0], 1 + 36 * c);
    }
  });
  EXPECT_EQ(expected, 9);
  const BssrdfTable copy = read_table(*source);
  EXPECT_EQ(slice_of(copy, 2, 0)[5], slice_of(table, 2, 0)[5]);
  EXPECT_EQ(half_disc_offsets(24).size(), 897u);
  EXPECT_EQ(half_disc_offsets(14).size(), 307u);
}

}  // namespace
}  // namespace parian
