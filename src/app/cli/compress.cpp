// parian compress: a table or a fitted map -> K base materials per pixel (Yatagawa et al. 2019).
#include "compress/compress.h"

#include <fmt/format.h>

#include <memory>
#include <optional>

#include "app/cli/command.h"
#include "app/cli/inputs.h"
#include "app/cli/output.h"
#include "app/report/provenance.h"
#include "base/error.h"
#include "base/stopwatch.h"
#include "compress/choose.h"
#include "compress/pictures.h"
#include "fit/fit.h"
#include "io/blend/blend_file.h"
#include "io/hdf5/map_file.h"
#include "io/hdf5/table_file.h"
#include "io/image/image_file.h"
#include "io/json/files.h"
#include "judge/compare.h"

namespace parian {
namespace {

struct CompressOptions {
  std::string input, output, table, start, watch;
  CompressParams params;
  FitParams fit;
  BlendEncoding encoding = BlendEncoding::packed;
  std::uint64_t max_bytes = 0;
  double max_error = 0;
};

// What is compressed, and what errors are measured against.
struct Source {
  ProfileMap map;
  std::unique_ptr<SliceSource> table;  // null where there is none
  FitReport fit;                       // empty for maps
};

Source open_source(const CompressOptions& options, const Progress& progress) {
  Source source;
  const FileKind kind = find_file_kind(options.input);
  if (kind == FileKind::blend)
    throw Error({options.input, {}, "a table or a profile map", "a blend"});
  if (kind == FileKind::map) {
    FitParams given = options.fit, defaults;
    check_unused(describe(given), describe(defaults), "a table to fit", options.input);
    source.map = load_profile_map(options.input);
    if (!options.table.empty()) source.table = open_table(options.table);
    return source;
  }
  if (!options.table.empty())
    throw Error({{}, "--table", "a profile map to compress", options.input}, ErrorKind::usage);
  source.table = open_table(options.input);
  FitResult fit = fit_profiles(*source.table, options.fit, progress);
  source.map = std::move(fit.map);
  source.map.provenance = make_fit_provenance(*source.table, options.fit);
  source.fit = fit.report;
  return source;
}

// The blend's errors against the table, or against the map where there is none.
CompareReport judge(const Source& source, const ProfileBlend& blend, const Progress& progress) {
  const Material model = blend;
  if (source.table != nullptr)
    return compare(*source.table, *make_slices(model, source.table->header()), source.map.hold_out,
                   progress);
  const Material map = source.map;
  const TableHeader header = natural_header(map);
  return compare(*make_slices(map, header), *make_slices(model, header), {}, progress);
}

// Pictures of a run, round by round, and the blend to go on from with --start.
void write_round(const std::string& folder, const CompressState& state) {
  const ProfileBlend blend = make_blend(state);
  const std::string path = fmt::format("{}/round-{:03}", folder, state.history.size() - 1);
  save_image(path + "-weights.png", make_weight_image(blend));
  save_image(path + "-indices.png", make_index_image(blend));
  save_blend(folder + "/latest.kbm", blend, BlendEncoding::paper);
}

// With its provenance, as it will be written.
ProfileBlend finish(const CompressOptions& options, const Source& source,
                    const CompressParams& params, ProfileBlend blend) {
  blend.provenance = make_blend_provenance(options.input, source.map.provenance, params);
  return blend;
}

std::size_t measure_bytes(const CompressOptions& options, const ProfileBlend& blend) {
  return encode_blend(blend, options.encoding).size();
}

void set_lattice(const CompressOptions& options, CompressParams& params) {
  if (options.encoding != BlendEncoding::packed) return;
  if (params.weight_levels == 0) params.weight_levels = default_weight_levels;
  if (params.profile_step == 0) params.profile_step = default_profile_step;
}

CompressParams choose(const CompressOptions& options, const Source& source,
                      const std::shared_ptr<const BlendObjective>& objective,
                      const Progress& progress) {
  if (options.max_bytes == 0 && options.max_error <= 0) return options.params;
  const bool packed = options.encoding == BlendEncoding::packed;
  return choose_params(
      source.map, objective, options.params,
      {static_cast<std::size_t>(options.max_bytes), options.max_error}, packed,
      {.bytes =
           [&](const ProfileBlend& blend) { return encode_blend(blend, options.encoding).size(); },
       .error =
           [&](const ProfileBlend& blend) { return judge(source, blend, {}).relative_error.mean; }},
      progress);
}

CompressState run(const CompressOptions& options, const Source& source,
                  const CompressParams& params, std::shared_ptr<const BlendObjective> objective,
                  const Progress& progress) {
  std::optional<ProfileBlend> start;
  if (!options.start.empty()) start = load_blend(options.start);
  CompressState state =
      make_compress_state(source.map, std::move(objective), params, start ? &*start : nullptr);
  while (!state.done) {
    if (!options.watch.empty()) write_round(options.watch, state);
    advance_progress(progress, "compressing", progress_of(state));
    advance(state);
  }
  if (!options.watch.empty()) write_round(options.watch, state);
  return state;
}

struct Compressed {
  CompressState state;
  ProfileBlend blend;
};

// The best blend within --max-bytes: fewer bases until the file fits, where short runs foretold too
// small a one.
Compressed run_within(const CompressOptions& options, const Source& source, CompressParams& params,
                      const std::shared_ptr<const BlendObjective>& objective,
                      const Progress& progress) {
  while (true) {
    CompressState state = run(options, source, params, objective, progress);
    ProfileBlend blend = finish(options, source, params, make_blend(state));
    const std::size_t bytes = options.max_bytes == 0 ? 0 : measure_bytes(options, blend);
    if (bytes <= options.max_bytes) return {std::move(state), std::move(blend)};
    if (params.bases == 1)
      throw Error({{},
                   "--max-bytes",
                   fmt::format("at least {}", bytes),
                   fmt::format("{}", options.max_bytes)});
    const double part = static_cast<double>(options.max_bytes) / static_cast<double>(bytes);
    params.bases = std::max(1, std::min(params.bases - 1, static_cast<int>(params.bases * part)));
  }
}

Document make_figures(const CompressState& state, const BlendBytes& bytes,
                      const CompareReport& errors, double seconds) {
  Document figures = to_document(CompressReport{state.history, state.run.energy, seconds});
  set(figures, "bases", state.run.mixture.base_count());
  set(figures, "per_pixel", state.run.mixture.per_pixel);
  set(figures, "weight_levels", state.params.weight_levels);
  set(figures, "profile_step", state.params.profile_step);
  set(figures, "errors", to_document(errors));
  Document spent{Document::Object{}};
  set(spent, "file", bytes.file);
  set(spent, "profiles", bytes.profiles);
  set(spent, "indices", bytes.indices);
  set(spent, "weights", bytes.weights);
  set(spent, "overhead", bytes.overhead);
  set(figures, "bytes", spent);
  return figures;
}

std::string summarise(const CompressOptions& options, const CompressState& state,
                      const BlendBytes& bytes, const CompareReport& errors, double seconds) {
  const ProfileMap& map = state.header;
  std::string text = fmt::format("{}: {} x {} pixels, {} of {} bases each, {} bytes\n",
                                 options.output, map.width, map.height, state.run.mixture.per_pixel,
                                 state.run.mixture.base_count(), bytes.file);
  text += fmt::format("  profiles {}, indices {}, weights {}, overhead {}\n", bytes.profiles,
                      bytes.indices, bytes.weights, bytes.overhead);
  text += fmt::format(
      "  mean relative error {:.4f}, mean albedo error {:.4f}, {:.1f} dB under uniform light\n",
      errors.relative_error.mean, errors.albedo_error_mean, errors.psnr_db.uniform);
  return text + fmt::format("  objective {:.6g} after {} rounds, {:.2f} seconds\n",
                            state.run.energy, state.history.size() - 1, seconds);
}

void compress(const CompressOptions& options, const Context& context) {
  std::vector<std::string> inputs{options.input};
  for (const std::string& input : {options.table, options.start})
    if (!input.empty()) inputs.push_back(input);
  check_output(options.output, inputs);
  if (!options.watch.empty()) make_folder(options.watch);
  CompressParams checked = options.params;
  check(describe(checked));
  const Stopwatch watch;
  const Source source = open_source(options, context.progress);
  const auto objective = make_blend_objective(source.map, source.table.get(),
                                              options.params.objective, context.progress);
  CompressParams params = choose(options, source, objective, context.progress);
  set_lattice(options, params);
  const auto [state, blend] = run_within(options, source, params, objective, context.progress);
  save_blend(options.output, blend, options.encoding);
  const double seconds = watch.seconds();
  const BlendBytes bytes = measure_blend_file(options.output);
  CompareReport errors = judge(source, blend, context.progress);
  errors.bytes_material = bytes.file;
  write_figures(context, make_figures(state, bytes, errors, seconds));
  print_summary(context, summarise(options, state, bytes, errors, seconds));
}

ParamList describe_options(CompressOptions& options) {
  ParamList params = describe(options.params);
  params.push_back({.name = "encoding",
                    .help = "packed: on a lattice, entropy-coded; paper: floats, as published",
                    .target = make_choice(options.encoding, {"paper", "packed"})});
  params.push_back({.name = "max-bytes",
                    .help = "choose K, M and the lattice for the least error within this size; 0: "
                            "as given",
                    .target = &options.max_bytes});
  params.push_back({.name = "max-error",
                    .help = "choose K, M and the lattice for the least size within this mean "
                            "relative error; 0: as given",
                    .target = &options.max_error,
                    .min = 0,
                    .max = 10});
  for (Param& param : describe(options.fit))  // what shapes a fit; tables only
    if (param.name == "segments" || param.name == "radius-mm" || param.name == "knots-mm" ||
        param.name == "lambda" || param.name == "fill-unmeasured")
      params.push_back(std::move(param));
  return params;
}

}  // namespace

CommandSpec make_compress_command() {
  const auto options = std::make_shared<CompressOptions>();
  CommandSpec command;
  command.name = "compress";
  command.summary = "turn a table or a fitted map into a blend of few base materials";
  command.example = "parian compress stone.h5 -o stone.kbm -M 128 -K 2";
  command.positionals = {{"INPUT", "table, or profile map", &options->input}};
  command.flags = {
      {"output", 'o', "OUT.kbm", "blend to write", &options->output, /*required=*/true},
      {"table", 't', "TABLE.h5", "table that the map was fitted to: errors are then the table's",
       &options->table},
      {"start", 's', "BLEND.kbm", "go on from this blend, of K or fewer bases per pixel",
       &options->start},
      {"watch", 'w', "FOLDER", "write pictures of weights and indices, and the blend, each round",
       &options->watch}};
  command.params = describe_options(*options);
  command.has_figures = true;
  command.run = [options](const Context& context) { compress(*options, context); };
  return command;
}

}  // namespace parian
