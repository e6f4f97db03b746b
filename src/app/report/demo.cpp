#include "app/report/demo.h"

#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "acquire/sample.h"
#include "app/report/html.h"
#include "app/report/sample_pipeline.h"
#include "app/report/shape_pictures.h"
#include "base/error.h"
#include "io/hdf5/table_file.h"
#include "io/image/image_file.h"
#include "io/json/files.h"
#include "io/json/json.h"

namespace parian {
namespace {

void simulate_table(const std::string& description, const std::string& table,
                    const Progress& progress) {
  const std::filesystem::path folder = std::filesystem::path(description).parent_path();
  const Sample sample = read_sample(load_document(description), [&](const std::string& name) {
    return load_image((folder / name).string());
  });
  const std::unique_ptr<SliceSource> source = make_analytic_source(sample);
  const auto sink = create_table(table, source->header());
  copy_slices(*source, *sink, progress);
}

std::string describe_table_size(const std::string& path) {
  const TableHeader header = open_table(path)->header();
  return fmt::format("{} × {} pixels of {} mm, {} offsets up to {:.1f} mm, {} channels.",
                     header.width, header.height, header.pixel_pitch_mm, header.offsets.size(),
                     radius_px(header) * header.pixel_pitch_mm, header.channels);
}

std::string write_page(const std::string& folder, const std::vector<PipelineSample>& samples,
                       const std::vector<PipelineResult>& results, const std::string& shape) {
  std::string body = html_paragraph(
      "Each sample is a table of R_d between pairs of surface points. A scattering profile is "
      "fitted to every point and channel, so that R_d between two points is the geometric mean of "
      "their profiles (SubEdit, Song et al. 2009); the fit is then judged against the table. All "
      "samples are simulated, not measured: the first two tables come from the dipole with "
      "coefficients averaged along the path between the points, the third from photons traced "
      "through a volume of voxels. No product of profiles meets any of them exactly.");
  body += html_table(tabulate(samples, results));
  for (std::size_t i = 0; i < samples.size(); ++i)
    body += describe_pipeline(samples[i], results[i]);
  body += shape;
  std::string path = folder + "/index.html";
  write_text(path, html_page("Parian: from a table to fitted profiles", body));
  return path;
}

}  // namespace

std::string find_data_folder() {
  std::error_code ignored;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", ignored);
  const std::filesystem::path installed = program.parent_path().parent_path() / "share" / "parian";
  if (std::filesystem::exists(installed / "samples", ignored)) return installed.string();
  return PARIAN_SOURCE_DIR "/data";
}

std::string make_demo(const DemoParams& params, const Progress& progress) {
  const std::string& folder = params.folder;
  const std::string description =
      params.data + (params.small ? "/samples/chessboard-small.json" : "/samples/chessboard.json");
  const std::string stone = params.data + "/stone-72x64.h5", board = folder + "/chessboard.h5";
  const std::string embedded = params.data + "/embedded-stones-48.h5";
  make_folder(folder);
  check_writable(folder + "/index.html");
  simulate_table(description, board, progress);
  const std::vector<PipelineSample> samples{
      {"chessboard", "Chessboard",
       "Simulated by Parian from two materials with measured coefficients. " +
           describe_table_size(board),
       description, board, folder},
      {"stone", "Stone",
       "A simulated table from an independent writer, bundled with Parian. " +
           describe_table_size(stone),
       "", stone, folder},
      {"embedded", "Embedded stones",
       "Simulated by Parian's photon engine, bundled: ellipsoids of three materials in a fourth, "
       "some of them under the surface (data/samples/embedded-stones.json). Errors include the "
       "noise of the photons. " +
           describe_table_size(embedded),
       "", embedded, folder}};
  std::vector<PipelineResult> results;
  results.reserve(samples.size());
  for (const PipelineSample& sample : samples) results.push_back(run_pipeline(sample, progress));
  const std::string shape = make_shape_pictures(
      {folder + "/stone-map.h5", stone, params.assets, folder, params.small}, progress);
  return write_page(folder, samples, results, shape);
}

}  // namespace parian
