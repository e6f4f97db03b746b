#include "app/report/sample_pipeline.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <memory>

#include "app/report/html.h"
#include "app/report/pictures.h"
#include "app/report/provenance.h"
#include "io/blend/blend_file.h"
#include "io/hdf5/map_file.h"
#include "io/hdf5/table_file.h"
#include "io/image/image_file.h"
#include "io/json/json.h"
#include "judge/false_color.h"
#include "judge/relight.h"
#include "material/material.h"

namespace parian {
namespace {

constexpr std::array<const char*, 3> light_names{"uniform", "disc", "line"};
constexpr float difference_gain = 10;

std::string path_of(const PipelineSample& sample, const std::string& ending) {
  return sample.folder + "/" + sample.name + "-" + ending;
}

// At least 192 pixels wide, by whole factors.
void save_enlarged(const std::string& path, const Image& image) {
  save_image(path, magnify(image, std::max(1, (192 + image.width - 1) / image.width)));
}

// Table and fit get one gain, so that they can be compared by eye; the brightest value becomes 0.9.
std::vector<float> save_relit(const PipelineSample& sample, const SliceSource& table,
                              const SliceSource& model, const SliceSource& blend,
                              const Progress& progress) {
  const TableHeader& header = table.header();
  std::vector<Image> lights;
  for (FlatLight light : {FlatLight::uniform, FlatLight::disc, FlatLight::line})
    lights.push_back(make_flat_light(light, header.width, header.height, header.channels));
  const std::vector<Image> measured = relight(table, lights, progress);
  const std::vector<Image> fitted = relight(model, lights, progress);
  const std::vector<Image> blended = relight(blend, lights, progress);
  std::vector<float> gains;
  for (std::size_t i = 0; i < lights.size(); ++i) {
    const std::string stem = path_of(sample, light_names[i]);
    const double largest = std::max(largest_value(measured[i]), 1e-30);
    const float gain = static_cast<float>(0.9 / largest);
    save_enlarged(stem + "-table.png", scale(measured[i], gain));
    save_enlarged(stem + "-fit.png", scale(fitted[i], gain));
    save_enlarged(stem + "-blend.png", scale(blended[i], gain));
    save_enlarged(stem + "-difference.png",
                  scale(absolute_difference(measured[i], fitted[i]), difference_gain * gain));
    gains.push_back(gain);
  }
  return gains;
}

void save_plots(const PipelineSample& sample, const SliceSource& table, const SliceSource& model,
                const Material& material, const std::vector<PlotPixel>& pixels) {
  const std::vector<Image> plots =
      plot_profiles(table, model, &material, pixels, table.header().channels / 2);
  for (std::size_t i = 0; i < plots.size(); ++i)
    save_image(path_of(sample, fmt::format("profile-{}.png", i + 1)), plots[i]);
}

Image draw_errors(const Image& errors) {
  const int magnification = std::max(1, (320 + errors.width - 1) / errors.width);
  return draw_color_map(errors, largest_value(errors), magnification, "relative error per pixel");
}

std::string percent(double value) {
  return fmt::format("{:.2f} %", 100 * value);
}

// As a user would type them in the current folder.
std::vector<std::string> commands_of(const PipelineSample& sample, const PipelineResult& result) {
  const auto shorten = [](const std::string& path) {
    return std::filesystem::proximate(path).string();
  };
  const std::string table = shorten(sample.table), stem = shorten(path_of(sample, ""));
  std::vector<std::string> lines;
  if (!sample.source.empty())
    lines.push_back(fmt::format("parian simulate {} -o {}", shorten(sample.source), table));
  lines.push_back(fmt::format("parian fit {0} -o {1}map.h5 --json {1}fit.json", table, stem));
  lines.push_back(fmt::format("parian compress {0} -o {1}blend.kbm", table, stem));
  std::string plots;
  for (const PlotPixel& pixel : result.plotted)
    plots += fmt::format(" --plot {},{}", pixel.x, pixel.y);
  lines.push_back(fmt::format(
      "parian compare {0} {1}map.h5 --json {1}errors.json --error-image {1}errors.png{2}", table,
      stem, plots));
  for (std::size_t i = 0; i < light_names.size(); ++i) {
    const std::string light = fmt::format("--light {} --exposure {:.3f}", light_names[i],
                                          std::log2(result.light_gains[i]));
    lines.push_back(fmt::format("parian relight {0} {1} -o {2}{3}-table.png", table, light, stem,
                                light_names[i]));
    lines.push_back(fmt::format("parian relight {0}map.h5 --like {1} {2} -o {0}{3}-fit.png", stem,
                                table, light, light_names[i]));
    lines.push_back(fmt::format("parian relight {0}blend.kbm --like {1} {2} -o {0}{3}-blend.png",
                                stem, table, light, light_names[i]));
  }
  return lines;
}

// As `parian compress TABLE` does by default.
ProfileBlend make_packed_blend(const PipelineSample& sample, const SliceSource& table,
                               const ProfileMap& map, const Progress& progress,
                               CompressReport& report) {
  CompressParams params;
  params.weight_levels = default_weight_levels;
  params.profile_step = default_profile_step;
  ProfileBlend blend = compress_profiles(map, &table, params, progress, &report);
  blend.provenance = make_blend_provenance(sample.table, map.provenance, params);
  save_blend(path_of(sample, "blend.kbm"), blend, BlendEncoding::packed);
  return blend;
}

}  // namespace

PipelineResult run_pipeline(const PipelineSample& sample, const Progress& progress) {
  const std::unique_ptr<SliceSource> table = open_table(sample.table);
  FitResult fitted = fit_profiles(*table, {}, progress);
  fitted.map.provenance = make_fit_provenance(*table, {});
  PipelineResult result;
  result.fit = fitted.report;
  result.knots = fitted.map.knots_mm.size();
  const std::string map_path = path_of(sample, "map.h5");
  save_profile_map(map_path, fitted.map);
  save_document(path_of(sample, "fit.json"), to_document(fitted.report));

  const Material material = std::move(fitted.map);
  const auto& map = std::get<ProfileMap>(material);
  const std::unique_ptr<SliceSource> model = make_slices(material, table->header(), map_path);
  result.errors = compare(*table, *model, map.hold_out, progress);
  result.errors.bytes_material = std::filesystem::file_size(map_path);
  save_document(path_of(sample, "errors.json"), to_document(result.errors));
  save_image(path_of(sample, "errors.png"), draw_errors(result.errors.error_image));
  const Material blend = make_packed_blend(sample, *table, map, progress, result.compress);
  const std::unique_ptr<SliceSource> blended = make_slices(blend, table->header());
  result.blend_errors = compare(*table, *blended, map.hold_out, progress);
  result.blend_errors.bytes_material = std::filesystem::file_size(path_of(sample, "blend.kbm"));
  result.light_gains = save_relit(sample, *table, *model, *blended, progress);
  result.plotted = {{map.width / 4, map.height / 4},
                    {map.width / 2, map.height / 2},
                    {3 * map.width / 4, map.height / 2}};
  save_plots(sample, *table, *model, material, result.plotted);
  return result;
}

std::string describe_pipeline(const PipelineSample& sample, const PipelineResult& result) {
  std::vector<std::string> rows;
  std::vector<std::vector<HtmlFigure>> pictures;
  for (std::size_t i = 0; i < light_names.size(); ++i) {
    const std::string name = light_names[i];
    rows.push_back(fmt::format("{} (gain {:.2g})", name, result.light_gains[i]));
    const std::string stem = sample.name + "-" + name;
    pictures.push_back({{stem + "-table.png", name + " light, table"},
                        {stem + "-fit.png", name + " light, fit"},
                        {stem + "-blend.png", name + " light, blend"},
                        {stem + "-difference.png", name + " light, difference"}});
  }
  std::vector<HtmlFigure> plots;
  for (std::size_t i = 0; i < result.plotted.size(); ++i)
    plots.push_back({fmt::format("{}-profile-{}.png", sample.name, i + 1),
                     fmt::format("around pixel ({}, {})", result.plotted[i].x, result.plotted[i].y),
                     /*pixelated=*/false});
  const MinMeanMax& errors = result.errors.relative_error;
  std::string text = html_heading(sample.title) + html_paragraph(sample.caption);
  text += html_paragraph(fmt::format(
      "The flat sample under three lights: as the table gives it, as the fitted profiles give it, "
      "as a blend of 128 base profiles gives it, two at each pixel, and {} times the difference of "
      "table and fit. All are shown with the same gain.",
      difference_gain));
  text += html_picture_table(
      {"table", "fit", "blend", fmt::format("difference × {}", difference_gain)}, rows, pictures);
  text += html_paragraph(
      "The table's values and the model's at the same pairs of points, and the profile of the "
      "point "
      "itself, over distance:");
  text += html_figures(plots, static_cast<int>(plots.size()));
  text += html_figures(
      {{sample.name + "-errors.png", fmt::format("Relative error per pixel: mean {}, largest {}.",
                                                 percent(errors.mean), percent(errors.max))}},
      3);
  return text +
         html_paragraph("The same from the command line (the page's pictures are enlarged):") +
         html_code(commands_of(sample, result));
}

std::vector<std::vector<std::string>> tabulate(const std::vector<PipelineSample>& samples,
                                               const std::vector<PipelineResult>& results) {
  std::vector<std::vector<std::string>> rows{{""},
                                             {"knots"},
                                             {"relative error, mean"},
                                             {"relative error, largest"},
                                             {"albedo error, mean"},
                                             {"albedo error, largest"},
                                             {"log RMS"},
                                             {"PSNR, uniform light"},
                                             {"PSNR, disc"},
                                             {"PSNR, line"},
                                             {"SSIM, uniform light"},
                                             {"SSIM, disc"},
                                             {"SSIM, line"},
                                             {"table"},
                                             {"profile map"},
                                             {"time to fit"},
                                             {"profile blend"},
                                             {"its relative error, mean"},
                                             {"its albedo error, mean"},
                                             {"its PSNR, uniform light"},
                                             {"time to compress"}};
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const CompareReport& errors = results[i].errors;
    const FitReport& fit = results[i].fit;
    const CompareReport& blend = results[i].blend_errors;
    const std::vector<std::string> cells{
        samples[i].title,
        fmt::format("{}", results[i].knots),
        percent(errors.relative_error.mean),
        percent(errors.relative_error.max),
        percent(errors.albedo_error_mean),
        percent(errors.albedo_error_max),
        fmt::format("{:.4f}", errors.log_rms),
        fmt::format("{:.1f} dB", errors.psnr_db.uniform),
        fmt::format("{:.1f} dB", errors.psnr_db.disc),
        fmt::format("{:.1f} dB", errors.psnr_db.line),
        fmt::format("{:.5f}", errors.ssim.uniform),
        fmt::format("{:.5f}", errors.ssim.disc),
        fmt::format("{:.5f}", errors.ssim.line),
        fmt::format("{:.1f} MB", 1e-6 * static_cast<double>(errors.bytes_table)),
        fmt::format("{:.1f} MB", 1e-6 * static_cast<double>(errors.bytes_material)),
        fmt::format("{:.2f} s", fit.seconds_stream + fit.seconds_solve + fit.seconds_monotone),
        fmt::format("{:.0f} kB", 1e-3 * static_cast<double>(blend.bytes_material)),
        percent(blend.relative_error.mean),
        percent(blend.albedo_error_mean),
        fmt::format("{:.1f} dB", blend.psnr_db.uniform),
        fmt::format("{:.1f} s", results[i].compress.seconds)};
    for (std::size_t k = 0; k < rows.size(); ++k) rows[k].push_back(cells[k]);
  }
  return rows;
}

}  // namespace parian
