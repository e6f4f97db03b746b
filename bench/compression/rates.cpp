// Bytes against error for all methods on one sample.
#include <fmt/format.h>

#include <functional>

#include "bench/compression/study.h"
#include "bench/reference/linsss.h"
#include "bench/reference/lsp_clusters.h"
#include "bench/reference/peers_2006.h"
#include "bench/reference/truncated_svd.h"
#include "bench/reference/tucker.h"
#include "io/blend/blend_file.h"
#include "judge/plot.h"

namespace parian::compression {
namespace {

struct Point {
  std::size_t bytes = 0;
  CompareReport errors;
};
struct Curve {
  std::string name;
  std::array<float, 3> color{};
  std::vector<Point> points;
};

Curve rival_curve(const Sample& sample, const std::string& name, std::array<float, 3> color,
                  const std::function<Rival(const BssrdfTable&, std::size_t)>& compress) {
  Curve curve{name, color, {}};
  const auto source = make_slices(sample.table, sample.name);
  std::size_t before = 0;
  for (std::size_t kilobytes : {20, 50, 100, 200, 500, 1000, 2000, 5000}) {
    std::fprintf(stderr, "%s, %zu kB\n", name.c_str(), kilobytes);
    const Rival rival = compress(sample.table, kilobytes * 1000);
    if (!rival.slices || rival.bytes == before) continue;
    before = rival.bytes;
    curve.points.push_back({rival.bytes, compare(*source, *rival.slices)});
  }
  return curve;
}

Curve blend_curve(const Sample& sample, bool packed, std::array<float, 3> color) {
  Curve curve{packed ? "Parian, packed" : "Parian, paper encoding", color, {}};
  struct Size {
    int per_pixel, bases;
  };
  for (const Size size : {Size{1, 16}, Size{1, 64}, Size{2, 16}, Size{2, 32}, Size{2, 64},
                          Size{2, 128}, Size{2, 256}, Size{3, 256}, Size{4, 256}, Size{6, 256}}) {
    CompressParams params = make_params(size.bases, size.per_pixel);
    if (packed) {
      params.weight_levels = default_weight_levels;
      params.profile_step = default_profile_step;
    }
    const Compressed compressed = compress_sample(sample, params);
    const std::size_t bytes =
        encode_blend(compressed.blend, packed ? BlendEncoding::packed : BlendEncoding::paper)
            .size();
    curve.points.push_back({bytes, compressed.errors});
  }
  return curve;
}

std::vector<Curve> measure(const Sample& sample) {
  std::vector<Curve> curves;
  curves.push_back(blend_curve(sample, true, {0.75f, 0.05f, 0.03f}));
  curves.push_back(blend_curve(sample, false, {0.9f, 0.4f, 0.1f}));
  const auto with_seed = [](auto compress) {
    return [compress](const BssrdfTable& table, std::size_t bytes) {
      return compress(table, bytes, 1);
    };
  };
  curves.push_back(
      rival_curve(sample, "LSP clusters", {0.1f, 0.4f, 0.1f}, with_seed(compress_lsp_clusters)));
  curves.push_back(rival_curve(sample, "Peers 2006", {0.05f, 0.15f, 0.6f},
                               [](const BssrdfTable& table, std::size_t bytes) {
                                 return compress_peers_2006(table, bytes);
                               }));
  curves.push_back(rival_curve(sample, "LinSSS", {0.4f, 0.1f, 0.5f}, with_seed(compress_linsss)));
  curves.push_back(
      rival_curve(sample, "SVD", {0.1f, 0.5f, 0.55f}, with_seed(compress_truncated_svd)));
  curves.push_back(rival_curve(sample, "Tucker", {0.35f, 0.3f, 0.05f}, with_seed(compress_tucker)));
  Curve map{"SubEdit map", {0, 0, 0}, {}};
  map.points.push_back({4 * sample.map.log_profile.size(), judge(sample, sample.map)});
  curves.push_back(map);
  return curves;
}

Image draw(const std::vector<Curve>& curves, const std::string& title, const std::string& label,
           const std::function<double(const CompareReport&)>& value) {
  Plot plot{.title = title,
            .x_label = "kB",
            .y_label = label,
            .log_x = true,
            .log_y = true,
            .series = {},
            .width = 820,
            .height = 560};
  for (const Curve& curve : curves) {
    PlotSeries line{.label = curve.name, .x = {}, .y = {}, .color = curve.color};
    for (const Point& point : curve.points) {
      line.x.push_back(static_cast<double>(point.bytes) / 1e3);
      line.y.push_back(value(point.errors));
    }
    PlotSeries dots = line;
    dots.label.clear();
    dots.points = true;
    dots.size = 7;
    if (line.x.size() == 1) std::swap(line.label, dots.label);
    plot.series.push_back(line);
    plot.series.push_back(dots);
  }
  return draw_plot(plot);
}

}  // namespace

void study_rates(const Page& page) {
  for (const char* name : {"artificial-stone", "blue-wax"}) {
    const Sample sample = load_sample(name);
    const std::vector<Curve> curves = measure(sample);
    MarkdownTable table{{"method", "kB", "relative error", "albedo error", "PSNR dB"}, {}};
    for (const Curve& curve : curves)
      for (const Point& point : curve.points)
        table.rows.push_back({curve.name, format_kb(point.bytes),
                              fmt::format("{:.4f}", point.errors.relative_error.mean),
                              fmt::format("{:.4f}", point.errors.albedo_error_mean),
                              fmt::format("{:.2f}", point.errors.psnr_db.uniform)});
    write_table(page, fmt::format("rates-{}", name),
                fmt::format("{} (`./run bench compress rates`)", name), table);
    write_picture(page, fmt::format("rates-relative-{}", name),
                  draw(curves, fmt::format("{}: mean relative error", name), "mean relative error",
                       [](const CompareReport& errors) { return errors.relative_error.mean; }));
    write_picture(page, fmt::format("rates-albedo-{}", name),
                  draw(curves, fmt::format("{}: mean albedo error", name), "mean albedo error",
                       [](const CompareReport& errors) { return errors.albedo_error_mean; }));
  }
}

}  // namespace parian::compression
