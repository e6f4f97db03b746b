// parian precompute: a scene -> the transport of its mesh under its lights.
#include "transport/precompute.h"

#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>

#include "app/cli/command.h"
#include "app/cli/inputs.h"
#include "app/cli/output.h"
#include "app/report/provenance.h"
#include "base/error.h"
#include "io/hdf5/transport_file.h"

namespace parian {
namespace {

struct PrecomputeOptions {
  std::string scene, output;
  PrecomputeParams params;
};

void warn(const Context& context, const std::string& text) {
  if (!context.quiet) fmt::print(stderr, "parian: warning: {}\n", text);
}

void check_scene(const Scene& scene, const std::string& path) {
  const auto* material = std::get_if<Material>(&scene.material);
  if (material == nullptr || !std::holds_alternative<Dipole>(*material))
    throw Error({path, "/material", "a homogeneous material, by coefficients or by name",
                 "'" + scene.material_name + "'"});
  if (!scene.layers.empty())
    throw Error({path, "/layers", "a scene of one material", "layers over it"});
  if (scene.lights.empty()) throw Error({path, "/lights", "at least one light", "none"});
}

// What an earlier run has left at `path`, if it is of the same scene and parameters.
std::optional<TransportFile> find_earlier(const std::string& path,
                                          const TransportFingerprint& fingerprint,
                                          const Context& context) {
  if (!std::filesystem::exists(path)) return {};
  try {
    TransportFile file = load_transport(path);
    if (file.fingerprint == fingerprint) return file;
  } catch (const Error& error) {
    warn(context, fmt::format("{}; it is made anew", error.what()));
  }
  return {};
}

Document to_document(const TransportFile& file, const PrecomputeReport& report) {
  const HomogeneousTransport& transport = file.transport;
  return Document::Object{{"vertices", transport.places},
                          {"samples", report.samples},
                          {"sample_spacing_mm", report.sample_spacing_mm},
                          {"lights", transport.lights.size()},
                          {"multiple_functions", transport.multiple_basis.size()},
                          {"single_functions", transport.lights[0].single.functions},
                          {"bytes", transport_bytes(transport)},
                          {"nodes_per_vertex", report.nodes_per_target},
                          {"escaping_fraction", report.escaping_fraction},
                          {"seconds", Document::Object{{"sampling", report.sampling_s},
                                                       {"irradiance", report.irradiance_s},
                                                       {"multiple", report.multiple_s},
                                                       {"single", report.single_s}}}};
}

std::string summarise(const std::string& output, const TransportFile& file,
                      const PrecomputeReport& report) {
  const HomogeneousTransport& transport = file.transport;
  return fmt::format(
      "{}: {} vertices, {} lights, {:.1f} MB\n"
      "  {} functions for R_d over {:.4g} mm, {} for the attenuation over {:.4g} mm\n"
      "  {} samples {:.3g} mm apart, {:.0f} nodes and samples for each vertex\n"
      "  seconds: {:.2f} sampling, {:.2f} irradiance, {:.2f} multiple, {:.2f} single scattering\n",
      output, transport.places, transport.lights.size(),
      static_cast<double>(transport_bytes(transport)) / 1e6, transport.multiple_basis.size(),
      transport.multiple_basis.knots.back(), transport.lights[0].single.functions,
      transport.single_basis.knots.back(), report.samples, report.sample_spacing_mm,
      report.nodes_per_target, report.sampling_s, report.irradiance_s, report.multiple_s,
      report.single_s);
}

void precompute_file(const PrecomputeOptions& options, const Context& context) {
  check_output(options.output, {options.scene});
  const LoadedScene loaded = load_scene(options.scene);
  check_output(options.output, loaded.files);
  for (const std::string& text : loaded.scene.warnings) warn(context, text);
  check_scene(loaded.scene, options.scene);

  TransportFile file;
  file.fingerprint = fingerprint_of(loaded.scene, options.params);
  const auto existing = find_earlier(options.output, file.fingerprint, context);
  if (existing && existing->is_complete())
    return print_summary(context, options.output + ": up to date\n");

  const std::string partial = options.output + ".partial";
  auto earlier = find_earlier(partial, file.fingerprint, context);
  const RayTracer tracer(loaded.scene.mesh);
  Precompute work(loaded.scene, tracer, options.params,
                  earlier ? std::move(earlier->transport) : HomogeneousTransport{},
                  context.progress);
  for (const std::string& text : work.report().warnings) warn(context, text);
  file.provenance = make_transport_provenance(options.scene, options.params);
  while (!work.is_done()) {
    work.advance(context.progress);
    file.transport = work.transport();
    if (!work.is_done()) save_transport(partial, file);
  }
  save_transport(options.output, file);
  std::error_code ignored;
  std::filesystem::remove(partial, ignored);
  write_figures(context, to_document(file, work.report()));
  print_summary(context, summarise(options.output, file, work.report()));
}

}  // namespace

CommandSpec make_precompute_command() {
  const auto options = std::make_shared<PrecomputeOptions>();
  CommandSpec command;
  command.name = "precompute";
  command.summary = "prepare a scene for live edits of a homogeneous material";
  command.example = "parian precompute examples/scenes/knot-live.json -o knot.h5";
  command.positionals = {{"SCENE.json", "scene description", &options->scene}};
  command.flags = {{.name = "output",
                    .letter = 'o',
                    .value_name = "TRANSPORT.h5",
                    .help = "transport to write; a run that was stopped is taken up again",
                    .target = &options->output,
                    .required = true}};
  command.params = describe(options->params);
  command.has_figures = true;
  command.run = [options](const Context& context) { precompute_file(*options, context); };
  return command;
}

}  // namespace parian
