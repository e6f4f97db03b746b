// parian info: what a file is, its sizes, statistics and provenance.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <memory>

#include "acquire/sample.h"
#include "app/cli/command.h"
#include "app/cli/inputs.h"
#include "app/cli/output.h"
#include "io/blend/blend_file.h"
#include "io/hdf5/map_file.h"
#include "io/hdf5/table_file.h"
#include "io/hdf5/transport_file.h"
#include "io/image/image_file.h"
#include "io/json/json.h"
#include "io/mesh/mesh_file.h"
#include "judge/row_sums.h"
#include "material/properties.h"
#include "math/statistics.h"

namespace parian {
namespace {

Document to_document(const Statistics& statistics) {
  if (statistics.count == 0) return nullptr;
  return Document::Object{
      {"min", statistics.min}, {"mean", mean(statistics)}, {"max", statistics.max}};
}

Document to_document(const std::vector<Statistics>& channels) {
  Document::Array array;
  for (const Statistics& channel : channels) array.push_back(to_document(channel));
  return array;
}

std::vector<Statistics> channel_statistics(const Image& image) {
  std::vector<Statistics> channels(static_cast<std::size_t>(image.channels));
  for (std::size_t i = 0; i < image.values.size(); ++i)
    if (std::isfinite(image.values[i])) add(channels[i % channels.size()], image.values[i]);
  return channels;
}

void describe_grid(Document& figures, const TableHeader& header) {
  set(figures, "width", header.width);
  set(figures, "height", header.height);
  set(figures, "channels", header.channels);
  set(figures, "pixel_pitch_mm", header.pixel_pitch_mm);
  set(figures, "boundary", header.boundary == Boundary::included ? "included" : "excluded");
  set(figures, "eta", header.eta);
}

void describe_offsets(Document& figures, const TableHeader& header) {
  set(figures, "offsets", header.offsets.size());
  set(figures, "radius_px", radius_px(header));
  set(figures, "radius_mm", radius_px(header) * header.pixel_pitch_mm);
  set(figures, "symmetric", header.symmetric);
  set(figures, "sampling", header.sampling == Sampling::area ? "area" : "point");
  set(figures, "bytes",
      4 * static_cast<std::size_t>(header.channels) * header.offsets.size() * header.pixels());
}

// Streams the table twice: for its values, and for its row sums.
void describe_values(Document& figures, const SliceSource& table, const Context& context) {
  const TableHeader& header = table.header();
  std::vector<Statistics> channels(static_cast<std::size_t>(header.channels));
  std::size_t pairs = 0, missing = 0, not_positive = 0;
  for_each_slice(table, context.progress, "reading", [&](int c, int d, const float* slice) {
    const PixelRange range = pairs_in_grid(header, header.offsets[static_cast<std::size_t>(d)]);
    for (int y = range.y0; y < range.y1; ++y)
      for (int x = range.x0; x < range.x1; ++x) {
        const double value = static_cast<double>(slice[y * header.width + x]);
        ++pairs;
        not_positive += value <= 0;
        if (std::isnan(value)) {
          ++missing;
        } else {
          add(channels[static_cast<std::size_t>(c)], value);
        }
      }
  });
  set(figures, "pairs", pairs);
  set(figures, "missing", missing);
  set(figures, "missing_share", static_cast<double>(missing) / static_cast<double>(pairs));
  set(figures, "not_positive", not_positive);
  set(figures, "reflectance", to_document(channels));
  const RowSums sums = measure_row_sums(table, context.progress);
  set(figures, "albedo", to_document(channel_statistics(sums.albedo)));
  set(figures, "albedo_above_one", sums.above_one);
}

Document describe_table(const std::string& path, const Context& context) {
  const std::unique_ptr<SliceSource> table = open_table(path);
  const TableHeader& header = table->header();
  Document figures = Document::Object{{"file", path}, {"kind", "BSSRDF table"}};
  describe_grid(figures, header);
  describe_offsets(figures, header);
  if (header.has_noise_model()) {
    Document::Array floor(header.noise_floor.begin(), header.noise_floor.end());
    Document::Array gain(header.noise_gain.begin(), header.noise_gain.end());
    set(figures, "noise_floor", std::move(floor));
    set(figures, "noise_gain", std::move(gain));
  }
  describe_values(figures, *table, context);
  set(figures, "provenance", read_provenance(header.provenance));
  return figures;
}

template <typename Grid>
void describe_profiles(Document& figures, const Grid& map) {
  std::vector<Statistics> albedo(static_cast<std::size_t>(map.channels));
  std::vector<Statistics> range(albedo.size()), radius(albedo.size()), support(albedo.size());
  std::size_t extrapolated = 0, limited = 0;
  for (int c = 0; c < map.channels; ++c)
    for (int y = 0; y < map.height; ++y)
      for (int x = 0; x < map.width; ++x) {
        const Profile profile = get_profile(map, c, x, y);
        const ProfileProperties properties = measure_properties(profile);
        const auto channel = static_cast<std::size_t>(c);
        add(albedo[channel], properties.albedo);
        add(range[channel], properties.range_mm);
        add(radius[channel], properties.mean_radius_mm);
        add(support[channel], profile.support_mm);
        extrapolated += properties.range_kind == RangeKind::extrapolated ? 1 : 0;
        limited += properties.range_kind == RangeKind::limited ? 1 : 0;
      }
  set(figures, "albedo", to_document(albedo));
  set(figures, "range_mm", to_document(range));
  set(figures, "ranges_extrapolated", extrapolated);
  set(figures, "ranges_limited", limited);
  set(figures, "mean_radius_mm", to_document(radius));
  set(figures, "support_mm", to_document(support));
}

// What profile maps and blends have in common, before and after what they have not.
template <typename Grid>
Document begin_material(const std::string& path, const char* kind, const Grid& grid) {
  TableHeader header;
  header.width = grid.width;
  header.height = grid.height;
  header.channels = grid.channels;
  header.pixel_pitch_mm = grid.pixel_pitch_mm;
  header.boundary = grid.boundary;
  header.eta = grid.eta;
  Document figures = Document::Object{{"file", path}, {"kind", kind}};
  describe_grid(figures, header);
  set(figures, "knots", grid.knots_mm.size());
  set(figures, "knots_mm", Document::Array(grid.knots_mm.begin(), grid.knots_mm.end()));
  set(figures, "has_gain", !grid.gain.empty());
  set(figures, "has_dilation", !grid.dilation.empty());
  set(figures, "held_out", grid.hold_out.fraction);
  set(figures, "bytes", static_cast<std::size_t>(std::filesystem::file_size(path)));
  return figures;
}

template <typename Grid>
Document finish_material(Document figures, const Grid& grid) {
  describe_profiles(figures, grid);
  set(figures, "provenance", read_provenance(grid.provenance));
  return figures;
}

Document describe_map(const std::string& path) {
  const ProfileMap map = load_profile_map(path);
  return finish_material(begin_material(path, "profile map", map), map);
}

// At how many pixels each base has the largest weight: min, mean, max over the bases.
Document describe_base_use(const ProfileBlend& blend) {
  std::vector<std::size_t> count(blend.bases(), 0);
  std::array<float, max_bases_per_pixel> weights{};
  const auto end = weights.begin() + blend.per_pixel;
  for (std::size_t x = 0; x < blend.pixels(); ++x) {
    get_weights(blend, x, weights.data());
    const auto k =
        static_cast<std::size_t>(std::max_element(weights.begin(), end) - weights.begin());
    ++count[blend.index[k * blend.pixels() + x]];
  }
  Statistics use;
  for (std::size_t pixels : count) add(use, static_cast<double>(pixels));
  return to_document(std::vector<Statistics>{use});
}

Document describe_blend(const std::string& path) {
  const ProfileBlend blend = load_blend(path);
  const BlendBytes bytes = measure_blend_file(path);
  Document figures = begin_material(path, "profile blend", blend);
  set(figures, "encoding", bytes.encoding == BlendEncoding::packed ? "packed" : "paper");
  set(figures, "bytes_profiles", bytes.profiles);
  set(figures, "bytes_indices", bytes.indices);
  set(figures, "bytes_weights", bytes.weights);
  set(figures, "bytes_gain_dilation", bytes.gain_dilation);
  set(figures, "bytes_overhead", bytes.overhead);
  set(figures, "bytes_as_paper", paper_bytes(blend));
  set(figures, "bases", blend.bases());
  set(figures, "per_pixel", blend.per_pixel);
  set(figures, "profile_step", blend.grid.profile_step);
  set(figures, "weight_levels", blend.grid.weight_levels);
  set(figures, "pixels_per_base", describe_base_use(blend));
  return finish_material(std::move(figures), blend);
}

Document describe_image(const std::string& path) {
  const Image image = load_image(path);
  return Document::Object{{"file", path},
                          {"kind", "image"},
                          {"width", image.width},
                          {"height", image.height},
                          {"channels", image.channels},
                          {"values", to_document(channel_statistics(image))}};
}

Document describe_sample(const std::string& path) {
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  const Sample sample = read_sample(load_document(path), [&](const std::string& name) {
    return load_image((folder / name).string());
  });
  const TableHeader header = make_analytic_source(sample)->header();
  Document figures = Document::Object{{"file", path}, {"kind", "sample description"}};
  describe_grid(figures, header);
  describe_offsets(figures, header);
  set(figures, "provenance", read_provenance(header.provenance));
  return figures;
}

void describe_surface(Document& figures, const TriangleMesh& mesh, const MeshReport& report) {
  const Vec3 size = extent(bounds(mesh));
  set(figures, "triangles", mesh.triangles.size());
  set(figures, "vertices", mesh.positions.size());
  set(figures, "size", Document::Array{double(size.x), double(size.y), double(size.z)});
  set(figures, "area", surface_area(mesh));
  set(figures, "volume", enclosed_volume(mesh));
  set(figures, "has_texture_coordinates", !mesh.texcoords.empty());
  set(figures, "unused_vertices", report.unused_vertices);
  set(figures, "merged_vertices", report.merged_vertices);
  set(figures, "degenerate_triangles", report.degenerate_triangles);
  set(figures, "cancelled_triangles", report.cancelled_triangles);
  set(figures, "flipped_triangles", report.flipped_triangles);
  set(figures, "boundary_edges", report.boundary_edges);
  set(figures, "nonmanifold_edges", report.nonmanifold_edges);
}

Document describe_mesh(const std::string& path) {
  MeshReport report;
  const TriangleMesh mesh = load_mesh(path, &report);
  Document figures = Document::Object{{"file", path}, {"kind", "mesh"}};
  describe_surface(figures, mesh, report);
  return figures;
}

Document describe_scene(const std::string& path) {
  const LoadedScene loaded = load_scene(path);
  const Scene& scene = loaded.scene;
  Document figures = Document::Object{{"file", path}, {"kind", "scene"}};
  set(figures, "width", scene.camera.width);
  set(figures, "height", scene.camera.height);
  set(figures, "mesh", scene.mesh_name);
  describe_surface(figures, scene.mesh, loaded.mesh);
  set(figures, "material", scene.material_name);
  set(figures, "boundary",
      boundary_of(scene.material) == Boundary::included ? "included" : "excluded");
  set(figures, "eta", eta_of(scene.material));
  if (!scene.layers.empty()) {
    Document::Array names;
    names.reserve(scene.layers.size());
    for (const SurfaceLayer& layer : scene.layers) names.emplace_back(layer.material_name);
    set(figures, "layers", std::move(names));
  }
  set(figures, "lights", scene.lights.size());
  set(figures, "warnings", Document::Array(scene.warnings.begin(), scene.warnings.end()));
  return figures;
}

Document describe_transport(const std::string& path) {
  const TransportFile file = load_transport(path);
  const HomogeneousTransport& transport = file.transport;
  Document::Array names;
  for (const LightTransport& light : transport.lights) names.emplace_back(light.name);
  return Document::Object{
      {"file", path},
      {"kind", "transport"},
      {"vertices", transport.places},
      {"eta", transport.eta},
      {"degree", transport.multiple_basis.degree},
      {"knots", transport.knots == KnotChoice::published ? "published" : "balanced"},
      {"multiple_functions", transport.multiple_basis.size()},
      {"multiple_reach_mm", transport.multiple_basis.knots.back()},
      {"single_functions", transport.single_basis.size()},
      {"single_reach_mm", transport.single_basis.knots.back()},
      {"lights", std::move(names)},
      {"complete", file.is_complete()},
      {"bytes", transport_bytes(transport)},
      {"provenance", read_provenance(file.provenance)}};
}

// Scenes and samples are both JSON: a scene has a mesh.
Document describe_json(const std::string& path) {
  const Document document = load_document(path);
  const bool is_scene =
      std::holds_alternative<Document::Object>(document.value) && find(document, "mesh");
  return is_scene ? describe_scene(path) : describe_sample(path);
}

Document describe_file(const std::string& path, const Context& context) {
  switch (find_file_kind(path)) {
    case FileKind::map:
      return describe_map(path);
    case FileKind::blend:
      return describe_blend(path);
    case FileKind::transport:
      return describe_transport(path);
    case FileKind::image:
      return describe_image(path);
    case FileKind::mesh:
      return describe_mesh(path);
    case FileKind::json:
      return describe_json(path);
    default:
      return describe_table(path, context);
  }
}

// Documents as aligned lines, "name  value"; nested ones as JSON.
std::string format_lines(const Document& figures) {
  std::string text;
  std::size_t width = 16;
  for (const auto& [key, value] : as_object(figures)) width = std::max(width, key.size());
  for (const auto& [key, value] : as_object(figures)) {
    const auto* string = std::get_if<std::string>(&value.value);
    std::string shown = string ? *string : format_document(value);
    if (std::holds_alternative<Document::Array>(value.value)) {  // on one line
      shown.erase(std::remove(shown.begin(), shown.end(), '\n'), shown.end());
      shown.erase(std::unique(shown.begin(), shown.end(),
                              [](char a, char b) { return a == ' ' && b == ' '; }),
                  shown.end());
    }
    text += fmt::format("{:<{}} {}\n", key, width, shown);
  }
  return text;
}

}  // namespace

CommandSpec make_info_command() {
  const auto file = std::make_shared<std::string>();
  CommandSpec command;
  command.name = "info";
  command.summary = "say what a file is: sizes, statistics, provenance";
  command.example = "parian info stone.h5";
  command.positionals = {
      {"FILE",
       "table, profile map, blend, transport, image, mesh, or description of a sample or scene",
       file.get()}};
  command.has_figures = true;
  command.run = [file](const Context& context) {
    const Document figures = describe_file(*file, context);
    write_figures(context, figures);
    print_summary(context, format_lines(figures));
  };
  return command;
}

}  // namespace parian
