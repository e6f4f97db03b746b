#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "base/parallel.h"
#include "base/stopwatch.h"
#include "gl/layered_textures.h"
#include "gl/splat_renderer_internal.h"

namespace parian {
namespace {

bool is_same(const SampleGrid& a, const SampleGrid& b) {
  return a.width == b.width && a.height == b.height && a.pixel_pitch_mm == b.pixel_pitch_mm;
}

Program make_resolve_program(const std::vector<std::string>& of_material, bool is_single,
                             bool is_sparse) {
  std::vector<std::string> defines = of_material;
  if (is_single) defines.emplace_back("SINGLE");
  if (is_single && is_sparse) defines.emplace_back("MEAN");
  return make_program({"screen_vertex.glsl"},
                      {"camera.glsl", "facing.glsl", "material.glsl", "resolve_fragment.glsl"},
                      defines);
}

std::vector<Vec2> map_samples(const std::vector<SurfacePoint>& samples, const Mapping& mapping,
                              const SampleGrid& grid) {
  std::vector<Vec2> places(samples.size());
  parallel_for_blocks(samples.size(), 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const SamplePoint place = map_to_sample(mapping, grid, samples[i]);
      places[i] = {static_cast<float>(place.x), static_cast<float>(place.y)};
    }
  });
  return places;
}

}  // namespace

void SplatRenderer::Impl::set_material(const Material& next) {
  Stopwatch watch;
  scene.material = next;
  ProfileField field = make_profile_field(next);
  const bool is_first = material == nullptr;
  const bool same_boundary =
      !is_first && material->boundary == field.boundary && material->eta == field.eta;
  const SampleGrid next_grid{field.width, field.height, field.pixel_pitch_mm};
  const bool same_grid = !is_first && is_same(grid, next_grid);
  const bool was_sparse = !is_first && material->is_sparse;
  const int old_levels = radial.count;
  grid = next_grid;
  std::optional<ProfileField> layered;
  if (!scene.layers.empty()) layered = make_sample_field(scene, samples);
  const bool was_layered = std::exchange(is_layered, layered.has_value());
  if (is_layered) field = std::move(*layered);
  max_support_mm = static_cast<double>(field.max_support_mm);
  const double first = params.octave * std::sqrt(area_mm2);
  radial = make_radial_levels(first, params.overlap, max_support_mm);
  material = std::make_unique<MaterialTextures>(
      make_material_textures(is_layered ? nullptr : std::get_if<ProfileBlend>(&next), field, radial,
                             area_mm2, near.near_mm));
  near_kernel = make_near_kernel(material->reference, near.near_mm);
  const bool same_sources =
      same_boundary && same_grid && radial.count == old_levels && was_layered == is_layered;
  if (!same_sources) place_samples();
  if (!same_sources && same_boundary) put_flux();
  make_material_programs();
  bake_profiles(sources, programs.rows, *material);
  groups_are_old = pixels_are_old = true;
  geometry_is_drawn = geometry_is_drawn && same_grid;
  view_is_old = view_is_old || radial.count != old_levels || material->is_sparse != was_sparse;
  report.material_s = watch.lap();
  report.levels = radial.count;
  report.splats = 0;
  for (const SourceLevel& level : sources.levels)
    report.splats += static_cast<std::size_t>(level.count);
}

// Where the samples lie in the textures of the material.
void SplatRenderer::Impl::place_samples() {
  std::vector<Vec2> places;
  if (is_layered) {
    places.reserve(samples.size());
    for (std::size_t i = 0; i < samples.size(); ++i) places.push_back(sample_place(i));
  } else {
    places = map_samples(samples, scene.mapping, grid);
  }
  sources = make_sources(samples, places, area_mm2, radial);
}

void SplatRenderer::Impl::make_material_programs() {
  const bool is_sparse = material->is_sparse;
  std::vector<std::string> of_samples = material->defines;
  if (is_layered) of_samples.push_back(fmt::format("PIXELS {}", params.antialias));
  const auto fits = [&](const MaterialPrograms& made) {
    return made.defines == of_samples && made.is_sparse == is_sparse;
  };
  if (fits(programs)) return;
  std::swap(programs, other_programs);
  if (fits(programs)) return;
  std::vector<std::string> seen = of_samples;
  if (is_layered) seen.emplace_back("UNIFORM");
  programs.rows = make_rows_program(*material);
  programs.resolve_single = make_resolve_program(seen, true, is_sparse);
  programs.resolve_group = make_resolve_program(seen, false, is_sparse);
  programs.defines = of_samples;
  programs.is_sparse = is_sparse;
}

// Of layers: a texel for each pixel of the picture. Old until all are there: it can be cancelled.
void SplatRenderer::Impl::make_pixel_textures(const Progress& progress) {
  if (is_layered) {
    const ProfileField field = make_pixel_field(scene, *tracer, camera, params.antialias, progress);
    of_pixels = std::make_unique<MaterialTextures>(
        make_material_textures(nullptr, field, radial, area_mm2, near.near_mm));
  }
  pixels_are_old = false;
}

}  // namespace parian
