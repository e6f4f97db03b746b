#include "transport/gather_table.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "base/parallel.h"
#include "base/random.h"

namespace parian {
namespace {

constexpr float nan = std::numeric_limits<float>::quiet_NaN();

// value(x, y, d) at every pair inside the grid.
BssrdfTable make_table(int width, int height, double radius, double pitch,
                       const std::function<double(int, int, Offset)>& value) {
  TableHeader header;
  header.width = width;
  header.height = height;
  header.channels = 1;
  header.pixel_pitch_mm = pitch;
  header.offsets = half_disc_offsets(radius);
  BssrdfTable table = make_bssrdf_table(header);
  for (std::size_t d = 0; d < header.offsets.size(); ++d) {
    const PixelRange range = pairs_in_grid(header, header.offsets[d]);
    for (int y = range.y0; y < range.y1; ++y)
      for (int x = range.x0; x < range.x1; ++x)
        slice_of(table, 0, static_cast<int>(d))[y * width + x] =
            static_cast<float>(value(x, y, header.offsets[d]));
  }
  return table;
}

double falloff(Offset d, double pitch) {
  return std::exp(-length_px(d) * 0.9) / (pitch * pitch) * 0.3;
}

// A place on the sample that lies in the plane z = 0, x to the right and y down as in the picture.
TableGatherPoint on_plane(double px, double py, double pitch, bool mirrored = false) {
  TableGatherPoint point;
  point.position = {static_cast<float>(px * pitch), static_cast<float>(-py * pitch), 0};
  point.normal = {0, 0, 1};
  point.place.x = px;
  point.place.y = py;
  point.place.along_x = {mirrored ? -1.0f : 1.0f, 0, 0};
  point.place.along_y = {0, -1, 0};
  return point;
}

// Jittered samples, `density` along each side of a pixel.
TableGatherSources scatter(int width, int height, double pitch, int density, std::uint64_t seed) {
  TableGatherSources sources;
  Rng rng = make_rng(seed);
  for (int y = 0; y < height * density; ++y)
    for (int x = 0; x < width * density; ++x) {
      const double px = (x + sample_uniform(rng)) / density - 0.5;
      const double py = (y + sample_uniform(rng)) / density - 0.5;
      sources.points.push_back(on_plane(px, py, pitch));
    }
  sources.area_mm2 = pitch * pitch / (density * density);
  sources.flux.assign(sources.points.size(), Rgb{1, 1, 1} * static_cast<float>(sources.area_mm2));
  return sources;
}

TableGatherSources at_pixels(const TableHeader& header, const Image& light) {
  TableGatherSources sources;
  sources.area_mm2 = header.pixel_pitch_mm * header.pixel_pitch_mm;
  for (int y = 0; y < header.height; ++y)
    for (int x = 0; x < header.width; ++x) {
      sources.points.push_back(on_plane(x, y, header.pixel_pitch_mm));
      sources.flux.push_back(Rgb{1, 1, 1} *
                             (at(light, x, y, 0) * static_cast<float>(sources.area_mm2)));
    }
  return sources;
}

Image random_light(int width, int height) {
  Image light = make_image(width, height, 1);
  Rng rng = make_rng(3);
  for (float& value : light.values) value = static_cast<float>(sample_uniform(rng));
  return light;
}

// What the flat sample sends back: the sum over measured pairs, light leaving at x and entering at
// x + d, and the other way round where the table is symmetric.
Image relight(const BssrdfTable& table, const Image& light) {
  const TableHeader& header = table.header;
  Image lit = make_image(header.width, header.height, 1);
  const auto area = static_cast<float>(header.pixel_pitch_mm * header.pixel_pitch_mm);
  for (std::size_t i = 0; i < header.offsets.size(); ++i) {
    const Offset d = header.offsets[i];
    const float* slice = slice_of(table, 0, static_cast<int>(i));
    const PixelRange range = pairs_in_grid(header, d);
    for (int y = range.y0; y < range.y1; ++y)
      for (int x = range.x0; x < range.x1; ++x) {
        const float value = area * slice[y * header.width + x];
        at(lit, x, y, 0) += value * at(light, x + d.dx, y + d.dy, 0);
        if (header.symmetric && d != Offset{})
          at(lit, x + d.dx, y + d.dy, 0) += value * at(light, x, y, 0);
      }
  }
  return lit;
}

double varied(int x, int y, Offset d) {
  const double middle_x = x + 0.5 * d.dx, middle_y = y + 0.5 * d.dy;
  return falloff(d, 0.5) * (1 + 0.5 * std::sin(0.7 * middle_x) * std::cos(0.5 * middle_y) +
                            0.2 * std::sin(3.1 * d.dx + 1.7 * d.dy));
}

TEST(gather_table, equals_the_relit_flat_sample) {
  const BssrdfTable table = make_table(17, 13, 4.3, 0.5, varied);
  const Image light = random_light(17, 13);
  const Image expected = relight(table, light);
  const TableGatherSources sources = at_pixels(table.header, light);
  const std::vector<Rgb> found = gather_table(table, sources, sources.points, 0);
  // Pairs that leave the grid do not exist among the samples, so this holds up to the border.
  for (int y = 0; y < 13; ++y)
    for (int x = 0; x < 17; ++x)
      EXPECT_NEAR(found[static_cast<std::size_t>(y * 17 + x)].x, at(expected, x, y, 0),
                  2e-6 * static_cast<double>(at(expected, x, y, 0)) + 1e-7);
}

TEST(gather_table, equals_the_relit_flat_sample_where_both_directions_are_listed) {
  TableHeader header;
  header.width = 12;
  header.height = 11;
  header.channels = 1;
  header.symmetric = false;
  for (int dy = -2; dy <= 2; ++dy)
    for (int dx = -2; dx <= 2; ++dx) header.offsets.push_back({dx, dy});
  BssrdfTable table = make_bssrdf_table(header);
  Rng rng = make_rng(8);
  for (std::size_t d = 0; d < header.offsets.size(); ++d) {
    const PixelRange range = pairs_in_grid(header, header.offsets[d]);
    for (int y = range.y0; y < range.y1; ++y)
      for (int x = range.x0; x < range.x1; ++x)
        slice_of(table, 0, static_cast<int>(d))[y * 12 + x] =
            static_cast<float>(0.01 + sample_uniform(rng));
  }
  const Image light = random_light(12, 11);
  const Image expected = relight(table, light);
  const TableGatherSources sources = at_pixels(header, light);
  const std::vector<Rgb> found = gather_table(table, sources, sources.points, 0);
  for (int y = 0; y < 11; ++y)
    for (int x = 0; x < 12; ++x)
      EXPECT_NEAR(found[static_cast<std::size_t>(y * 12 + x)].x, at(expected, x, y, 0),
                  3e-6 * static_cast<double>(at(expected, x, y, 0)));
}

TEST(gather_table, uniform_plane_scatters_the_row_sum) {
  const double pitch = 0.5;
  const BssrdfTable table =
      make_table(24, 24, 4, pitch, [&](int, int, Offset d) { return falloff(d, pitch); });
  double row_sum = 0;
  for (const Offset d : table.header.offsets)
    row_sum += pair_count(table.header, d) * falloff(d, pitch) * pitch * pitch;
  for (const int density : {1, 2, 4}) {
    const TableGatherSources sources = scatter(24, 24, pitch, density, 5);
    std::vector<TableGatherPoint> targets;
    targets.reserve(40);
    for (int i = 0; i < 40; ++i) targets.push_back(on_plane(9.1 + 0.13 * i, 8.7 + 0.17 * i, pitch));
    const double spacing = std::sqrt(sources.area_mm2);
    double mean = 0;
    for (const Rgb& m : gather_table(table, sources, targets, 4 * spacing)) {
      // Jittered samples are far rougher than blue noise.
      EXPECT_NEAR(static_cast<double>(m.x), row_sum, (density == 4 ? 0.01 : 0.05) * row_sum);
      mean += static_cast<double>(m.x) / 40;
    }
    EXPECT_NEAR(mean, row_sum, (density == 1 ? 0.02 : 0.01) * row_sum) << density;
  }
}

TEST(gather_table, heterogeneous_plane_scatters_the_row_sum) {
  const double pitch = 0.5;
  const auto value = [&](int x, int y, Offset d) {
    const double u = x + 0.5 * d.dx, v = y + 0.5 * d.dy;
    return falloff(d, pitch) * (1 + 0.4 * std::sin(0.25 * u) + 0.02 * v);
  };
  const BssrdfTable table = make_table(28, 28, 4, pitch, value);
  const Image row_sums = relight(table, make_image(28, 28, 1, 1));
  const TableGatherSources sources = scatter(28, 28, pitch, 4, 6);
  std::vector<TableGatherPoint> targets;
  for (int i = 8; i < 20; ++i) targets.push_back(on_plane(i, 27 - i, pitch));
  const std::vector<Rgb> found =
      gather_table(table, sources, targets, 4 * std::sqrt(sources.area_mm2));
  for (int i = 8; i < 20; ++i) {
    const double expected = static_cast<double>(at(row_sums, i, 27 - i, 0));
    EXPECT_NEAR(static_cast<double>(found[static_cast<std::size_t>(i - 8)].x), expected,
                0.01 * expected);
  }
}

TEST(gather_table, window_below_the_spacing_is_lambertian) {
  const double pitch = 0.01;
  const BssrdfTable table =
      make_table(20, 20, 3, pitch, [&](int, int, Offset d) { return falloff(d, pitch); });
  double row_sum = 0;
  for (const Offset d : table.header.offsets)
    row_sum += pair_count(table.header, d) * falloff(d, pitch) * pitch * pitch;
  TableGatherSources sources;  // 1 mm apart
  Rng rng = make_rng(4);
  for (int y = 0; y < 20; ++y)
    for (int x = 0; x < 20; ++x) {
      TableGatherPoint point = on_plane(10, 10, pitch);
      point.position = {static_cast<float>(x + sample_uniform(rng)),
                        static_cast<float>(y + sample_uniform(rng)), 0};
      sources.points.push_back(point);
      sources.flux.push_back({2, 2, 2});
    }
  sources.area_mm2 = 1;
  TableGatherPoint target = on_plane(10, 10, pitch);
  for (int i = 0; i < 20; ++i) {
    target.position = {5.0f + 0.37f * static_cast<float>(i), 9.3f, 0};
    const Rgb m = gather_table(table, sources, {target}, 3).front();
    EXPECT_NEAR(static_cast<double>(m.x), 2 * row_sum, 0.01 * row_sum) << i;
  }
}

TEST(gather_table, symmetric_tables_are_reciprocal) {
  const BssrdfTable table = make_table(16, 16, 4, 0.5, varied);
  Rng rng = make_rng(12);
  const auto random_point = [&] {
    TableGatherPoint point = on_plane(15 * sample_uniform(rng), 15 * sample_uniform(rng), 0.5);
    const Vec3 normal = normalize({static_cast<float>(sample_uniform(rng) - 0.5),
                                   static_cast<float>(sample_uniform(rng) - 0.5), 1});
    const Frame frame = make_frame(normal);
    point.position.z = static_cast<float>(sample_uniform(rng));
    point.normal = normal;
    point.place.along_x = frame.tangent;
    point.place.along_y = frame.bitangent;
    return point;
  };
  int not_zero = 0;
  for (int i = 0; i < 200; ++i) {
    const TableGatherPoint a = random_point(), b = random_point();
    const float ab = gather_table(table, {{a}, {{1, 1, 1}}, 1}, {b}, 0).front().x;
    const float ba = gather_table(table, {{b}, {{1, 1, 1}}, 1}, {a}, 0).front().x;
    EXPECT_EQ(ab, ba);
    not_zero += ab > 0;
  }
  EXPECT_GT(not_zero, 20);
}

TEST(gather_table, distance_counts_in_space_and_direction_in_the_tangent_plane) {
  const double pitch = 0.5;
  // Grows along x alone, so that directions show.
  const BssrdfTable table = make_table(
      20, 20, 5, pitch, [](int, int, Offset d) { return 1 + 10.0 * d.dx * d.dx + d.dy * d.dy; });
  TableGatherPoint o = on_plane(10, 10, pitch), i = on_plane(10, 10, pitch);
  const auto value = [&] { return gather_table(table, {{i}, {{1, 1, 1}}, 1}, {o}, 0).front().x; };
  i.position = o.position + Vec3{0.9f, 0, 1.2f};  // 1.5 mm = 3 pixels along x
  EXPECT_NEAR(value(), 91, 1e-3);
  i.position = o.position + Vec3{0, 0.9f, 1.2f};
  EXPECT_NEAR(value(), 10, 1e-3);
  o.place.along_x = i.place.along_x = {0, 1, 0};  // the texture turned by 90 degrees
  o.place.along_y = i.place.along_y = {1, 0, 0};
  EXPECT_NEAR(value(), 91, 1e-3);
  i.position = o.position;
  i.position.z += 1;  // straight below: along x
  EXPECT_NEAR(value(), 41, 1e-3);
}

TEST(gather_table, is_zero_beyond_the_window_and_falls_to_it) {
  const double pitch = 0.5;
  const BssrdfTable table = make_table(30, 30, 4, pitch, [](int, int, Offset) { return 1.0; });
  const auto value = [&](double distance_px) {
    TableGatherPoint i = on_plane(15, 15, pitch);
    i.position.x += static_cast<float>(distance_px * pitch);
    return gather_table(table, {{i}, {{1, 1, 1}}, 1}, {on_plane(15, 15, pitch)}, 0).front().x;
  };
  EXPECT_FLOAT_EQ(value(3.9), 1);
  EXPECT_NEAR(value(4.25), 0.75, 1e-4);
  EXPECT_EQ(value(5.01), 0);
  EXPECT_EQ(value(40), 0);
}

TEST(gather_table, mirrored_tiles_read_reflected_pairs) {
  const double pitch = 0.5;
  const BssrdfTable table = make_table(10, 10, 3, pitch, varied);
  // Target at the right border; source one pixel further, in the mirrored tile: there pixel 9.
  const TableGatherPoint o = on_plane(9, 5, pitch);
  TableGatherPoint i = on_plane(9, 5, pitch, true);
  i.position.x += static_cast<float>(pitch);
  const float found = gather_table(table, {{i}, {{1, 1, 1}}, 1}, {o}, 0).front().x;
  // (1, 0) leaves the grid at both ends and is read as (-1, 0): the pair of pixels 8 and 9.
  EXPECT_FLOAT_EQ(found, static_cast<float>(varied(8, 5, {1, 0})));
}

TEST(gather_table, missing_values_are_left_out) {
  const double pitch = 0.5;
  BssrdfTable table = make_table(20, 20, 3, pitch, [](int, int, Offset) { return 2.0; });
  const auto value = [&](double px, double py, double dx) {
    TableGatherPoint i = on_plane(px, py, pitch);
    i.position.x += static_cast<float>(dx * pitch);
    return gather_table(table, {{i}, {{1, 1, 1}}, 1}, {on_plane(px, py, pitch)}, 0).front().x;
  };
  const int d = find_offset(table.header, {1, 0});
  slice_of(table, 0, d)[10 * 20 + 10] = nan;
  EXPECT_FLOAT_EQ(value(10.25, 10.25, 1.5), 2);  // others have its weight
  for (int y = 0; y < 20; ++y)
    for (int x = 0; x < 20; ++x) slice_of(table, 0, d)[y * 20 + x] = nan;
  EXPECT_FLOAT_EQ(value(10.25, 10.25, 1.5), 2);
  EXPECT_EQ(value(10, 10, 1), 0);  // none is left
}

TEST(gather_table, offsets_that_are_not_listed_between_others_count_as_missing) {
  TableHeader header;
  header.width = header.height = 20;
  header.channels = 1;
  for (int dy = 0; dy <= 4; dy += 2)
    for (int dx = dy == 0 ? 0 : -4; dx <= 4; dx += 2) header.offsets.push_back({dx, dy});
  BssrdfTable table = make_bssrdf_table(header);
  std::fill(table.reflectance.begin(), table.reflectance.end(), 3.0f);
  TableGatherPoint i = on_plane(10, 10, 1);
  i.position.x += 1.5f;
  i.position.y += 0.75f;
  EXPECT_FLOAT_EQ(gather_table(table, {{i}, {{1, 1, 1}}, 1}, {on_plane(10, 10, 1)}, 0).front().x,
                  3);
}

TEST(gather_table, threads_and_order_do_not_change_a_bit) {
  const BssrdfTable table = make_table(24, 24, 4, 0.5, varied);
  const TableGatherSources sources = scatter(24, 24, 0.5, 2, 5);
  std::vector<TableGatherPoint> targets = scatter(24, 24, 0.5, 1, 9).points;
  const auto gather = [&](int threads) {
    const ThreadLimit limit(threads);
    return gather_table(table, sources, targets, 1);
  };
  const std::vector<Rgb> one = gather(1);
  EXPECT_EQ(one, gather(2));
  std::reverse(targets.begin(), targets.end());
  std::vector<Rgb> reversed = gather(2);
  std::reverse(reversed.begin(), reversed.end());
  EXPECT_EQ(one, reversed);
}

}  // namespace
}  // namespace parian
