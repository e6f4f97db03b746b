#include <optional>

#include "base/parallel.h"
#include "render/places_internal.h"
#include "scene/mapping.h"
#include "transport/layered_field.h"

namespace parian {
namespace {

constexpr std::size_t block = 1024;

GatherPoint to_gather_point(const SurfacePoint& point, const SamplePoint& place) {
  return {point.position, point.normal, static_cast<float>(place.x), static_cast<float>(place.y)};
}
TableGatherPoint to_table_point(const SurfacePoint& point, const SamplePoint& place) {
  return {point.position, point.normal, place};
}

// point(i) for i < count, each through `convert` with its place in the sample.
template <typename Point, typename Get, typename Convert>
std::vector<Point> map_points(std::size_t count, const Get& get, const Mapping& mapping,
                              const SampleGrid& grid, const Convert& convert) {
  std::vector<Point> points(count);
  parallel_for_blocks(count, block, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const SurfacePoint& point = get(i);
      points[i] = convert(point, map_to_sample(mapping, grid, point));
    }
  });
  return points;
}

template <typename Point, typename Convert>
void map_all(const GatherInput& input, const SampleGrid& grid, const Convert& convert,
             std::vector<Point>& samples, std::vector<Point>& targets) {
  samples = map_points<Point>(
      input.samples.points.size(), [&](std::size_t i) { return input.samples.points[i]; },
      input.scene.mapping, grid, convert);
  targets = map_points<Point>(
      input.targets.size(), [&](std::size_t i) { return input.get_target(i); }, input.scene.mapping,
      grid, convert);
}

}  // namespace

SurfacePoint GatherInput::get_target(std::size_t i) const {
  return get_surface_point(scene.mesh, targets[i].triangle, targets[i].barycentric);
}

PlacedProfiles place_profiles(const GatherInput& input, const Material& material,
                              std::vector<Rgb> flux) {
  PlacedProfiles placed;
  placed.sources.flux = std::move(flux);
  placed.sources.area_mm2 = input.samples.area_mm2;
  placed.near_mm = default_near_mm(input.samples.area_mm2);
  const std::size_t count = input.samples.points.size(), all = count + input.targets.size();
  const auto get = [&](std::size_t i) {
    return i < count ? input.samples.points[i] : input.get_target(i - count);
  };
  std::vector<GatherPoint>& points = placed.sources.points;
  std::optional<ProfileField> layered;
  if (!input.scene.layers.empty()) layered = make_layered_field(input.scene, all, get);
  if (!layered) {
    placed.field = make_profile_field(material);
    const SampleGrid grid{placed.field.width, placed.field.height, placed.field.pixel_pitch_mm};
    map_all(input, grid, to_gather_point, points, placed.targets);
    return placed;
  }
  placed.field = std::move(*layered);
  points.resize(count);
  placed.targets.resize(input.targets.size());
  parallel_for_blocks(all, block, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const SurfacePoint point = get(i);
      const Vec2 place = layered_place(i);
      (i < count ? points[i] : placed.targets[i - count]) = {point.position, point.normal, place.x,
                                                             place.y};
    }
  });
  return placed;
}

PlacedTable place_table(const GatherInput& input, const BssrdfTable& table, std::vector<Rgb> flux) {
  PlacedTable placed;
  const TableHeader& header = table.header;
  map_all(input, {header.width, header.height, header.pixel_pitch_mm}, to_table_point,
          placed.sources.points, placed.targets);
  placed.sources.flux = std::move(flux);
  placed.sources.area_mm2 = input.samples.area_mm2;
  placed.near_mm = default_near_mm(input.samples.area_mm2);
  return placed;
}

}  // namespace parian
