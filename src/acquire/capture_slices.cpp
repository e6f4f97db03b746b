#include "acquire/capture_slices.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "acquire/capture_tails_internal.h"
#include "base/parallel.h"

namespace parian {
namespace {

constexpr float not_measured = std::numeric_limits<float>::quiet_NaN();

std::size_t pixel_index(const CaptureMeta& meta, int x, int y) {
  return static_cast<std::size_t>(y) * static_cast<std::size_t>(meta.width) +
         static_cast<std::size_t>(x);
}

// The dot of frame (i, j) that is nearest to a pixel along one axis.
int nearest_along(int x, int shift, int lattice, int size) {
  const int k = static_cast<int>(std::lround((x - shift) / static_cast<double>(lattice)));
  return shift + lattice * std::clamp(k, 0, dots_along(size, shift, lattice) - 1);
}

}  // namespace

void normalise_responses(const CaptureMeta& meta, const std::vector<float>& reference,
                         DotResponses& responses) {
  const std::size_t pixels =
      static_cast<std::size_t>(meta.width) * static_cast<std::size_t>(meta.height);
  const double factor = meta.reference_albedo / (meta.pixel_pitch_mm * meta.pixel_pitch_mm);
  const auto lattice = static_cast<std::size_t>(meta.lattice_px);
  parallel_for(lattice * lattice, [&](std::size_t frame) {
    const int i = static_cast<int>(frame % lattice), j = static_cast<int>(frame / lattice);
    for (int c = 0; c < meta.channels; ++c) {
      float* value = responses.value.data() + response_index(meta, i, j, c) * pixels;
      const float* ref = reference.data() + static_cast<std::size_t>(c) * pixels;
      for (int y = 0; y < meta.height; ++y)
        for (int x = 0; x < meta.width; ++x) {
          const int dot_x = nearest_along(x, i, meta.lattice_px, meta.width);
          const int dot_y = nearest_along(y, j, meta.lattice_px, meta.height);
          const double product = static_cast<double>(ref[pixel_index(meta, x, y)]) *
                                 ref[pixel_index(meta, dot_x, dot_y)];
          float& v = value[pixel_index(meta, x, y)];
          v = product > 0 ? static_cast<float>(v * factor / std::sqrt(product)) : not_measured;
        }
    }
  });
}

double remove_tails(const CaptureMeta& meta, DotResponses& responses) {
  const std::size_t pixels =
      static_cast<std::size_t>(meta.width) * static_cast<std::size_t>(meta.height);
  const auto lattice = static_cast<std::size_t>(meta.lattice_px);
  double taken = 0, all = 0;
  for (int c = 0; c < meta.channels; ++c) {
    const TailModel tail = make_tail_model(meta, responses, c);
    std::vector<double> frame_taken(lattice * lattice), frame_all(lattice * lattice);
    parallel_for(lattice * lattice, [&](std::size_t frame) {
      const int i = static_cast<int>(frame % lattice), j = static_cast<int>(frame / lattice);
      float* value = responses.value.data() + response_index(meta, i, j, c) * pixels;
      for (int y = 0; y < meta.height; ++y)
        for (int x = 0; x < meta.width; ++x) {
          const std::size_t nearest =
              pixel_index(meta, nearest_along(x, i, meta.lattice_px, meta.width),
                          nearest_along(y, j, meta.lattice_px, meta.height));
          double others = 0;
          for_each_dot(meta, i, j, x, y, [&](std::size_t r2, std::size_t dot) {
            if (dot != nearest) others += tail.at[r2] * tail.factor[dot];
          });
          const std::size_t pixel = pixel_index(meta, x, y);
          if (std::isnan(value[pixel])) continue;
          others *= tail.factor[pixel];
          frame_taken[frame] += others;
          frame_all[frame] += value[pixel];
          value[pixel] -= static_cast<float>(others);
        }
    });
    for (std::size_t frame = 0; frame < frame_all.size(); ++frame)
      taken += frame_taken[frame], all += frame_all[frame];
  }
  return all > 0 ? taken / all : 0;
}

BssrdfTable make_raw_table(const CaptureMeta& meta, const DotResponses& responses) {
  TableHeader header{.width = meta.width,
                     .height = meta.height,
                     .channels = meta.channels,
                     .pixel_pitch_mm = meta.pixel_pitch_mm,
                     .boundary = Boundary::included,
                     .eta = meta.eta,
                     .symmetric = false,
                     .sampling = Sampling::area};
  // Noise, so that values below 0 are data; its size is fitted later.
  header.noise_floor.assign(static_cast<std::size_t>(meta.channels), 0);
  header.noise_gain = header.noise_floor;
  for (const Offset d : half_disc_offsets(meta.radius_px)) {
    header.offsets.push_back(d);
    if (d != Offset{}) header.offsets.push_back({-d.dx, -d.dy});
  }
  BssrdfTable table = make_bssrdf_table(std::move(header));
  const std::size_t pixels = table.header.pixels();
  for (int c = 0; c < meta.channels; ++c)
    for (std::size_t k = 0; k < table.header.offsets.size(); ++k) {
      const Offset d = table.header.offsets[k];
      const PixelRange range = pairs_in_grid(table.header, d);
      float* slice = slice_of(table, c, static_cast<int>(k));
      for (int y = range.y0; y < range.y1; ++y)
        for (int x = range.x0; x < range.x1; ++x) {
          const int i = (x + d.dx) % meta.lattice_px, j = (y + d.dy) % meta.lattice_px;
          slice[pixel_index(meta, x, y)] =
              responses.value[response_index(meta, i, j, c) * pixels + pixel_index(meta, x, y)];
        }
    }
  return table;
}

int replace_centre(const CaptureMeta& meta, BssrdfTable& raw) {
  std::vector<int> inside, rings;
  for (std::size_t k = 0; k < raw.header.offsets.size(); ++k) {
    const double r = length_px(raw.header.offsets[k]);
    if (r < meta.centre_px) inside.push_back(static_cast<int>(k));
    if (r >= meta.centre_px && r < meta.centre_px + 2.5) rings.push_back(static_cast<int>(k));
  }
  if (inside.empty()) return 0;
  for (int c = 0; c < meta.channels; ++c)
    for (std::size_t pixel = 0; pixel < raw.header.pixels(); ++pixel) {
      // ln R = a + b r by least squares.
      double n = 0, sum_r = 0, sum_rr = 0, sum_y = 0, sum_ry = 0;
      for (const int k : rings) {
        const float value = slice_of(raw, c, k)[pixel];
        if (!(value > 0)) continue;
        const double r = length_px(raw.header.offsets[static_cast<std::size_t>(k)]);
        const double y = std::log(value);
        n += 1, sum_r += r, sum_rr += r * r, sum_y += y, sum_ry += r * y;
      }
      const double determinant = n * sum_rr - sum_r * sum_r;
      const bool known = determinant > 1e-9;
      const double b = known ? std::min(0.0, (n * sum_ry - sum_r * sum_y) / determinant) : 0;
      const double a = known ? (sum_y - b * sum_r) / n : 0;
      for (const int k : inside) {
        float& value = slice_of(raw, c, k)[pixel];
        const double r = length_px(raw.header.offsets[static_cast<std::size_t>(k)]);
        if (!std::isnan(value))
          value = known ? static_cast<float>(std::exp(a + b * r)) : not_measured;
      }
    }
  return static_cast<int>(inside.size());
}

BssrdfTable symmetrise(const BssrdfTable& raw) {
  TableHeader header = raw.header;
  header.symmetric = true;
  header.offsets.clear();
  for (const Offset d : raw.header.offsets)
    if (d.dy > 0 || (d.dy == 0 && d.dx >= 0)) header.offsets.push_back(d);
  BssrdfTable table = make_bssrdf_table(std::move(header));
  const auto width = static_cast<std::size_t>(table.header.width);
  for (int c = 0; c < table.header.channels; ++c)
    for (std::size_t k = 0; k < table.header.offsets.size(); ++k) {
      const Offset d = table.header.offsets[k];
      const float* forth = slice_of(raw, c, find_offset(raw.header, d));
      const float* back = slice_of(raw, c, find_offset(raw.header, {-d.dx, -d.dy}));
      const PixelRange range = pairs_in_grid(table.header, d);
      float* slice = slice_of(table, c, static_cast<int>(k));
      for (int y = range.y0; y < range.y1; ++y)
        for (int x = range.x0; x < range.x1; ++x) {
          const std::size_t from =
              static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x);
          const std::size_t to =
              static_cast<std::size_t>(y + d.dy) * width + static_cast<std::size_t>(x + d.dx);
          slice[from] = std::isnan(forth[from]) ? back[to]
                        : std::isnan(back[to])  ? forth[from]
                                                : 0.5f * (forth[from] + back[to]);
        }
    }
  return table;
}

}  // namespace parian
