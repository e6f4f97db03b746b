// parian render: a scene -> a picture.
#include "render/render.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <memory>

#include "app/cli/command.h"
#include "app/cli/inputs.h"
#include "app/cli/output.h"
#include "app/cli/render_splat.h"
#include "app/cli/sweep.h"
#include "base/error.h"
#include "io/hdf5/transport_file.h"
#include "io/image/image_file.h"
#include "render/transport_renderer.h"

namespace parian {
namespace {

enum class Method { brute, tree, splat };

struct RenderOptions {
  std::string scene, output, transport, sweep;
  Method method = Method::tree;
  RenderParams params;
};

// The renderer's, with the graphics device as one more method.
ParamList describe(RenderOptions& options) {
  ParamList params = describe(options.params);
  params.front() = {.name = "method",
                    .help =
                        "how light is gathered: every sample, the moment tree, or splatting on "
                        "the graphics device; a table without a fit is always gathered from "
                        "every sample",
                    .target = make_choice(options.method, {"brute", "tree", "splat"})};
  return params;
}

// Those of `names` alone.
ParamList pick(ParamList params, const std::vector<std::string>& names) {
  std::erase_if(params, [&](const Param& param) {
    return std::find(names.begin(), names.end(), param.name) == names.end();
  });
  return params;
}

void check_method(const RenderOptions& options) {
  const bool has_transport = !options.transport.empty();
  if (options.method == Method::tree && !has_transport) return;
  std::vector<std::string> unused{"quality", "tolerance"};
  if (options.method == Method::splat || has_transport) unused.emplace_back("shading");
  if (has_transport) unused.insert(unused.end(), {"samples", "rays", "seed"});
  RenderOptions given = options, defaults;
  check_unused(pick(describe(given), unused), pick(describe(defaults), unused),
               has_transport ? "a picture without --transport" : "--method tree with it",
               has_transport                     ? options.transport
               : options.method == Method::splat ? "--method splat"
                                                 : "--method brute");
}

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
  else if (report.gather.starts_with("transport"))
    text += fmt::format(" from {}\n", report.gather);
  else if (report.gather == "splat")
    text += " by splatting\n";
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

// A picture with another homogeneous material in place of the scene's, or with that.
using FrameSource = std::function<RenderResult(const Dipole* material)>;

const Dipole& get_dipole(const Scene& scene, const std::string& flag) {
  const auto* material = std::get_if<Material>(&scene.material);
  const auto* dipole = material != nullptr ? std::get_if<Dipole>(material) : nullptr;
  if (dipole != nullptr) return *dipole;
  throw Error({{}, flag, "a scene of a homogeneous material", "'" + scene.material_name + "'"},
              ErrorKind::usage);
}

FrameSource make_frames(Scene& scene, const RenderOptions& options, const Context& context) {
  if (options.method == Method::splat && options.transport.empty())
    return make_splat_frames(scene, options.params, context.progress);
  if (options.transport.empty())
    return [&](const Dipole* material) {
      if (material != nullptr) scene.material = Material(*material);
      return render(scene, options.params, context.progress);
    };
  const Dipole own = get_dipole(scene, "--transport");
  auto file = std::make_shared<TransportFile>(load_transport(options.transport));
  if (!file->is_complete())
    throw Error(
        {options.transport, "attribute 'lights_done'",
         "transport of all lights; 'parian precompute' goes on with it",
         fmt::format("{} of {}", file->transport.lights.size(), file->fingerprint.lights.size())});
  check_fingerprint(*file, options.transport, fingerprint_of(scene, {}), false);
  if (file->transport.eta != own.eta)
    throw Error({options.transport, "attribute 'eta'", fmt::format("{}, the scene's", own.eta),
                 fmt::format("{}", file->transport.eta)});
  if (options.method == Method::splat)
    return make_live_frames(scene, file->transport, options.params);
  auto renderer =
      std::make_shared<TransportRenderer>(scene, file->transport, options.params, context.progress);
  return [file, renderer, own, &context](const Dipole* material) {
    return renderer->render(material != nullptr ? *material : own, context.progress);
  };
}

// With '#' in its name a file for each value, else one with all of them.
void render_sweep(const Scene& scene, const FrameSource& frames, const Sweep& sweep,
                  const RenderOptions& options, const Context& context) {
  const Dipole own = get_dipole(scene, "--sweep");
  if (sweep.name == "thickness_mm" && own.single_scattering)
    throw Error({{}, "--sweep", "a material without single_scattering for thickness_mm", "it"},
                ErrorKind::usage);
  const bool is_sequence = options.output.find('#') != std::string::npos;
  std::vector<Image> pictures;
  Document::Array figures;
  std::string text;
  for (std::size_t i = 0; i < sweep.values.size(); ++i) {
    const double value = sweep.values[i];
    const Dipole material = set_coefficient(own, sweep.name, value);
    RenderResult result = frames(&material);
    const std::string name = frame_name(options.output, i + 1);
    if (is_sequence)
      save_image(name, result.image);
    else
      pictures.push_back(std::move(result.image));
    if (i == 0) print_warnings(result.report.warnings, context);
    figures.push_back(Document::Object{{sweep.name, value},
                                       {"file", name},
                                       {"gather_s", result.report.gather_s},
                                       {"total_s", result.report.total_s}});
    text += fmt::format("{}: {} = {:.4g}, {:.4f} s gathering, {:.2f} s in all\n", name, sweep.name,
                        value, result.report.gather_s, result.report.total_s);
  }
  if (!is_sequence) save_image(options.output, make_contact_sheet(pictures));
  write_figures(context, Document::Object{{"frames", std::move(figures)}});
  print_summary(context, text);
}

// A name on the command line is checked before the scene is read, which may take seconds.
void render_file(RenderOptions options, const Context& context) {
  check_method(options);
  if (options.method == Method::brute) options.params.method = GatherMethod::brute;
  if (!options.output.empty()) {
    check_picture_name(options.output);
    check_output(options.output, {options.scene});
  }
  if (!options.sweep.empty()) parse_sweep(options.sweep);
  LoadedScene loaded = load_scene(options.scene);
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
  const FrameSource frames = make_frames(loaded.scene, options, context);
  if (!options.sweep.empty())
    return render_sweep(loaded.scene, frames, parse_sweep(options.sweep), options, context);
  const RenderResult result = frames(nullptr);
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
  command.flags = {
      {"output", 'o', "IMAGE", "image to write: .png, .exr or .hdr; default: the scene's",
       &options->output},
      {"transport", 0, "TRANSPORT.h5",
       "of 'parian precompute' for this scene: homogeneous materials at once", &options->transport},
      {"sweep", 0, "NAME=FIRST:LAST:COUNT",
       "sigma_a, sigma_s, sigma_s_prime, g or thickness_mm over a range: a contact sheet, or a "
       "picture for each value where the output's name has '#'",
       &options->sweep}};
  command.params = describe(*options);
  command.has_figures = true;
  command.run = [options](const Context& context) { render_file(*options, context); };
  return command;
}

}  // namespace parian
