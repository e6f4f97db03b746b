// parian render: a scene -> a picture.
#include "render/render.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>

#include "app/cli/command.h"
#include "app/cli/inputs.h"
#include "app/cli/output.h"
#include "base/error.h"
#include "io/image/image_file.h"

namespace parian {
namespace {

struct RenderOptions {
  std::string scene, output;
  RenderParams params;
};

void check_picture_name(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  for (const char* known : {".png", ".exr", ".hdr"})
    if (extension == known) return;
  throw Error({path, {}, "a file name that ends in .png, .exr or .hdr", "'" + extension + "'"},
              ErrorKind::usage);
}

void print_warnings(const std::vector<std::string>& warnings, const Context& context) {
  if (context.quiet) return;
  for (const std::string& warning : warnings) fmt::print(stderr, "parian: warning: {}\n", warning);
}

Document to_document(const MeshReport& mesh) {
  return Document::Object{{"unused_vertices", mesh.unused_vertices},
                          {"merged_vertices", mesh.merged_vertices},
                          {"degenerate_triangles", mesh.degenerate_triangles},
                          {"cancelled_triangles", mesh.cancelled_triangles},
                          {"flipped_triangles", mesh.flipped_triangles},
                          {"boundary_edges", mesh.boundary_edges},
                          {"nonmanifold_edges", mesh.nonmanifold_edges}};
}

Document number_or_null(double value, bool is_known) {
  return is_known ? Document(value) : Document(nullptr);
}

Document to_document(const RenderReport& report, const LoadedScene& loaded) {
  Document::Array warnings;
  for (const std::string& warning : loaded.scene.warnings) warnings.push_back(warning);
  for (const std::string& warning : report.warnings) warnings.push_back(warning);
  const bool is_certified = report.certified > 0;
  return Document::Object{{"gather", report.gather},
                          {"triangles", report.triangles},
                          {"vertices", report.vertices},
                          {"mesh", to_document(loaded.mesh)},
                          {"area_mm2", report.area_mm2},
                          {"samples", report.samples},
                          {"sample_spacing_mm", report.sample_spacing_mm},
                          {"targets", report.targets},
                          {"nodes_per_target", report.nodes_per_target},
                          {"certified_targets", report.certified},
                          {"max_half_width", number_or_null(report.max_half_width, is_certified)},
                          {"mean_half_width", number_or_null(report.mean_half_width, is_certified)},
                          {"escaping_fraction", report.escaping_fraction},
                          {"seconds", Document::Object{{"sampling", report.sampling_s},
                                                       {"irradiance", report.irradiance_s},
                                                       {"tree", report.tree_s},
                                                       {"gather", report.gather_s},
                                                       {"shading", report.shading_s},
                                                       {"total", report.total_s}}},
                          {"warnings", std::move(warnings)}};
}

std::string summarise(const RenderOptions& options, const Scene& scene,
                      const RenderReport& report) {
  std::string text = fmt::format("{}: {} x {} pixels, {} triangles of {:.6g} mm^2, material {}\n",
                                 options.output, scene.camera.width, scene.camera.height,
                                 report.triangles, report.area_mm2, scene.material_name);
  text += fmt::format("  {} samples {:.3g} mm apart, {} targets", report.samples,
                      report.sample_spacing_mm, report.targets);
  if (report.gather == "tree")
    text += fmt::format(" by the tree, {:.0f} nodes and samples each\n", report.nodes_per_target);
  else if (report.gather == "table")
    text += " from the table without a fit\n";
  else
    text += report.gather.empty() ? "\n" : " by brute force\n";
  if (report.certified > 0)
    text += fmt::format(
        "  certified half-width: {:.2g} % at most, {:.2g} % on average over {} targets\n",
        100 * report.max_half_width, 100 * report.mean_half_width, report.certified);
  return text + fmt::format(
                    "  seconds: {:.2f} sampling, {:.2f} irradiance, {:.2f} tree, {:.2f} gathering, "
                    "{:.2f} shading, {:.2f} in all\n",
                    report.sampling_s, report.irradiance_s, report.tree_s, report.gather_s,
                    report.shading_s, report.total_s);
}

// A name on the command line is checked before the scene is read, which may take seconds.
void render_file(RenderOptions options, const Context& context) {
  if (!options.output.empty()) {
    check_picture_name(options.output);
    check_output(options.output, {options.scene});
  }
  check_figures(context);
  const LoadedScene loaded = load_scene(options.scene);
  if (options.output.empty()) {
    if (loaded.scene.output.empty())
      throw Error({{}, "--output", "an image to write, here or as the scene's 'output'", "neither"},
                  ErrorKind::usage);
    options.output =
        (std::filesystem::path(options.scene).parent_path() / loaded.scene.output).string();
    check_picture_name(options.output);
  }
  check_output(options.output, loaded.files);
  print_warnings(loaded.scene.warnings, context);
  const RenderResult result = render(loaded.scene, options.params, context.progress);
  save_image(options.output, result.image);
  print_warnings(result.report.warnings, context);
  write_figures(context, to_document(result.report, loaded));
  print_summary(context, summarise(options, loaded.scene, result.report));
}

}  // namespace

CommandSpec make_render_command() {
  const auto options = std::make_shared<RenderOptions>();
  CommandSpec command;
  command.name = "render";
  command.summary = "show a material on a mesh under light";
  command.example = "parian render examples/scenes/knot-marble.json -o knot.png --quality 0.01";
  command.positionals = {{"SCENE.json", "scene description", &options->scene}};
  command.flags = {{"output", 'o', "IMAGE",
                    "image to write: .png, .exr or .hdr; default: the scene's", &options->output}};
  command.params = describe(options->params);
  command.has_figures = true;
  command.run = [options](const Context& context) { render_file(*options, context); };
  return command;
}

}  // namespace parian
