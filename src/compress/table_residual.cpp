#include "compress/table_residual.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "compress/pair_kernels.h"
#include "fit/noise_kernels.h"

namespace parian {
namespace {

// Where a row of pairs begins, at either end.
struct PairRow {
  std::size_t from = 0, to = 0, count = 0;
};

std::vector<PairRow> list_rows(const TableHeader& header, Offset offset) {
  const PixelRange range = pairs_in_grid(header, offset);
  std::vector<PairRow> rows;
  for (int y = range.y0; y < range.y1 && range.x0 < range.x1; ++y) {
    const auto from = static_cast<std::ptrdiff_t>(y) * header.width + range.x0;
    const auto to = from + static_cast<std::ptrdiff_t>(offset.dy) * header.width + offset.dx;
    rows.push_back({static_cast<std::size_t>(from), static_cast<std::size_t>(to),
                    static_cast<std::size_t>(range.x1 - range.x0)});
  }
  return rows;
}

// How much of R - R* is expected not to be noise: s^2 / (s^2 + v), when the map's misfit has the
// relative variance s^2 and the noise v.
void weigh_residuals(const TableHeader& header, int channel, const float* model,
                     std::vector<float>& trust) {
  const auto c = static_cast<std::size_t>(channel);
  const auto floor = static_cast<float>(header.noise_floor[c]),
             gain = static_cast<float>(header.noise_gain[c]);
  for (std::size_t i = 0; i < trust.size(); ++i) {
    const float misfit = model_error * model_error * model[i] * model[i];
    const float noise = floor * floor + gain * model[i];
    trust[i] = noise > 0 ? misfit / (misfit + noise) : 1.0f;
  }
}

}  // namespace

TableResidual measure_residual(const SliceSource& table, const ProfileMap& map,
                               const std::vector<float>& weight, const Progress& progress) {
  const TableHeader& header = table.header();
  const std::size_t pixels = map.pixels(), knots = map.knots_mm.size();
  const auto channels = static_cast<std::size_t>(map.channels);
  TableResidual residual{std::vector<float>(channels * pixels, 0.0f),
                         std::vector<float>(pixels, 0.0f),
                         std::vector<float>(channels * knots * pixels, 0.0f)};
  std::vector<float> model(pixels), miss(pixels), linear(pixels);
  std::vector<float> trust(pixels, 1.0f);
  for_each_slice(
      table, progress, "reading the table", [&](int channel, int index, const float* slice) {
        const Offset offset = header.offsets[static_cast<std::size_t>(index)];
        const double r = length_px(offset) * map.pixel_pitch_mm;
        if (r > map.knots_mm.back() * (1 + 1e-9)) return;
        const bool own = offset == Offset{};
        const float share = header.symmetric || own ? 1.0f : 0.5f;
        const auto c = static_cast<std::size_t>(channel);
        eval_slice(map, channel, offset, model.data());
        if (header.has_noise_model()) weigh_residuals(header, channel, model.data(), trust);
        std::fill(linear.begin(), linear.end(), 0.0f);
        float* albedo = &residual.albedo[c * pixels];
        for (const PairRow& row : list_rows(header, offset))
          add_residual(slice + row.from, model.data() + row.from, trust.data() + row.from,
                       weight.data() + row.from, weight.data() + row.to, share, row.count,
                       albedo + row.from, own ? nullptr : albedo + row.to,
                       residual.squared.data() + row.from,
                       own ? nullptr : residual.squared.data() + row.to, linear.data() + row.from,
                       linear.data() + row.to, miss.data());
        const auto above = std::upper_bound(map.knots_mm.begin(), map.knots_mm.end(), r);
        const auto k =
            std::min(static_cast<std::size_t>(above - map.knots_mm.begin()) - 1, knots - 2);
        const double left = map.knots_mm[k];
        const auto fraction =
            static_cast<float>(std::min(1.0, (r - left) / (map.knots_mm[k + 1] - left)));
        float* plane = &residual.linear[(c * knots + k) * pixels];
        add_scaled(linear.data(), 1 - fraction, plane, pixels);
        if (fraction > 0) add_scaled(linear.data(), fraction, plane + pixels, pixels);
      });
  return residual;
}

}  // namespace parian
