#include <fmt/format.h>

#include <algorithm>

#include "base/error.h"
#include "render/primary_internal.h"
#include "render/render.h"
#include "transport/gather_table.h"
#include "transport/layered_field.h"

#if defined(__unix__)
#include <unistd.h>
#endif

namespace parian {
namespace {

// Knots of the renderer's profiles, at most: dipoles and dilated maps are resampled.
constexpr std::size_t resampled_knots = 128;

struct ProfileSizes {
  std::size_t pixels = 1;
  std::size_t knots = resampled_knots;
};

template <typename Grid>
ProfileSizes sizes_of(const Grid& grid) {
  return {grid.pixels(), grid.dilation.empty() ? grid.knots_mm.size() + 16 : resampled_knots};
}
ProfileSizes sizes_of(const Dipole&) {
  return {};
}

// Of a blend more than it takes, as it keeps bases instead of a row for each pixel.
ProfileSizes profile_sizes(const Material& material) {
  return std::visit([](const auto& model) { return sizes_of(model); }, material);
}

std::size_t material_bytes(const Material& material, std::size_t samples, GatherMethod method) {
  const ProfileSizes sizes = profile_sizes(material);
  const std::size_t row = 3 * sizes.knots * sizeof(float);
  // A binary tree with several samples in each leaf; each emitter has values and slopes.
  const std::size_t nodes = method == GatherMethod::tree ? samples / 2 : 0;
  const std::size_t rows = (sizes.pixels > 1 ? samples : 1) + nodes;
  return sizes.pixels * row + 2 * rows * row + (samples + nodes) * 160;
}

// Rows for every sample and node, places and masks for every point, and each layer's own field.
std::size_t layer_bytes(const Scene& scene, std::size_t samples, std::size_t targets,
                        GatherMethod method) {
  if (scene.layers.empty()) return 0;
  ProfileSizes most = profile_sizes(std::get<Material>(scene.material));
  std::size_t fields = most.pixels * most.knots;
  for (const SurfaceLayer& layer : scene.layers) {
    const ProfileSizes sizes = profile_sizes(*layer.material);
    fields += sizes.pixels * sizes.knots;
    most.knots = std::max(most.knots, sizes.knots);
  }
  const std::size_t row = 3 * std::max(most.knots, layered_knots) * sizeof(float);
  const std::size_t nodes = method == GatherMethod::tree ? samples / 2 : 0;
  return fields * 3 * sizeof(float) + 2 * (samples + nodes) * row + (samples + nodes) * 160 +
         (samples + targets) * (scene.layers.size() + 1) * (sizeof(Vec2) + sizeof(float));
}

}  // namespace

std::size_t estimate_memory(const Scene& scene, const RenderParams& params) {
  const auto samples = static_cast<std::size_t>(params.samples);
  const auto pixels =
      static_cast<std::size_t>(scene.camera.width) * static_cast<std::size_t>(scene.camera.height);
  const auto sub_rays = static_cast<std::size_t>(params.antialias * params.antialias);
  const std::size_t targets = params.shading == Shading::vertex
                                  ? scene.mesh.positions.size()
                                  : pixels * std::min(sub_rays, max_targets_per_pixel);
  // Embree's tree and its copy of the mesh; normals and topology while the mesh is prepared.
  const std::size_t mesh = scene.mesh.triangles.size() * 160 + scene.mesh.positions.size() * 64;
  // Five candidates are drawn for each sample.
  const std::size_t sampling = samples * (sizeof(SurfacePoint) + 5 * 96);
  const std::size_t view = pixels * (sub_rays * sizeof(PrimaryHit) + sizeof(std::size_t) + 12);
  const std::size_t at_target = sizeof(MeshPlace) + sizeof(TableGatherPoint) + sizeof(Rgb) + 32;
  const std::size_t material =
      std::holds_alternative<BssrdfTable>(scene.material)
          ? gather_table_bytes(std::get<BssrdfTable>(scene.material).header) +
                samples * (sizeof(TableGatherPoint) + 32)
          : std::max(material_bytes(std::get<Material>(scene.material), samples, params.method),
                     layer_bytes(scene, samples, targets, params.method));
  return mesh + sampling + view + targets * at_target + material;
}

std::size_t physical_memory() {
#if defined(__unix__)
  const long pages = sysconf(_SC_PHYS_PAGES), size = sysconf(_SC_PAGESIZE);
  if (pages > 0 && size > 0)
    return static_cast<std::size_t>(pages) * static_cast<std::size_t>(size);
#endif
  return 0;
}

void check_memory(std::size_t needed, std::size_t limit, const std::string& advice) {
  if (limit == 0) limit = physical_memory();
  if (limit == 0 || needed <= limit) return;
  const auto gib = [](std::size_t bytes) { return static_cast<double>(bytes) / 0x1p30; };
  throw Error({{},
               "memory",
               fmt::format("{:.1f} GiB ({})", gib(needed), advice),
               fmt::format("{:.1f} GiB", gib(limit))},
              ErrorKind::resource);
}

}  // namespace parian
