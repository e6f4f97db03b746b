#include "transport/single_scattering.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>
#include <string_view>
#include <utility>

#include "base/check.h"
#include "base/error.h"
#include "base/parallel.h"
#include "transport/depth_layers.h"
#include "transport/single_scattering_kernels.h"

namespace parian {
namespace {

constexpr std::size_t points_per_block = 64;
constexpr std::size_t directions_per_step = 4;     // with depth maps, which are kept together
constexpr std::size_t point_light_places = 16384;  // per step
constexpr float bias_texels = 1.5f;

std::uint32_t spread_bits(std::uint32_t v) {  // of 10, to every third
  v = (v | (v << 16u)) & 0x030000ffu;
  v = (v | (v << 8u)) & 0x0300f00fu;
  v = (v | (v << 4u)) & 0x030c30c3u;
  return (v | (v << 2u)) & 0x09249249u;
}

// Along Morton's curve, so that neighbours in the list see the same texels.
std::vector<std::uint32_t> order_places(const std::vector<Vec3>& positions, const Bounds3& box) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> keys(positions.size());
  const float scale = 1023 / std::max(component(extent(box), longest_axis(box)), 1e-20f);
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const Vec3 p = (positions[i] - box.lower) * scale;
    const auto cell = [](float x) {
      return spread_bits(static_cast<std::uint32_t>(x > 0 ? std::min(x, 1023.0f) : 0.0f));
    };
    keys[i] = {cell(p.x) | (cell(p.y) << 1u) | (cell(p.z) << 2u), static_cast<std::uint32_t>(i)};
  }
  std::sort(keys.begin(), keys.end());
  std::vector<std::uint32_t> order;
  order.reserve(keys.size());
  for (const auto& [key, index] : keys) order.push_back(index);
  return order;
}

void append_point(const LightEntry& entry, float s, float weight, LitPath& lit) {
  lit.length[lit.count] = static_cast<float>(entry.length_mm) + s;
  float* source = lit.source[lit.count++];
  source[0] = weight * entry.light.x;
  source[1] = source[0] * entry.direction.x;
  source[2] = source[0] * entry.direction.y;
  source[3] = source[0] * entry.direction.z;
}

}  // namespace

ParamList describe(SingleScatteringParams& params) {
  return {{.name = "path-samples",
           .help = "points on each path into the object",
           .target = &params.path_samples,
           .min = 8,
           .max = static_cast<double>(max_path_samples)},
          {.name = "directions",
           .help = "directions of an environment light",
           .target = &params.directions,
           .min = 16,
           .max = 4096},
          {.name = "entries",
           .help = "how the light's entries are found: by depth maps or by rays",
           .target = make_choice(params.method, {"depth-layers", "rays"})},
          {.name = "resolution",
           .help = "of the depth maps: texels along the longer side",
           .target = &params.resolution,
           .min = 16,
           .max = 4096},
          {.name = "seed", .help = "of the environment's directions", .target = &params.seed}};
}

struct SingleTransportState::Impl {
  SingleScatteringParams params;
  const TriangleMesh* mesh = nullptr;
  const RayTracer* tracer = nullptr;
  float eta = 1;
  std::size_t nodes = 0, functions = 0;
  BasisTable table;
  std::vector<LightDirection> directions;
  std::optional<PointLight> lamp;
  // In the order of the places' work; value has the order of the points.
  std::vector<std::uint32_t> order;
  std::vector<Vec3> positions, inward;
  std::vector<float> path_mm;
  std::vector<DepthLayers> maps;  // of the step's directions
  std::size_t steps = 0, step = 0;
  std::vector<float> value;

  std::size_t row() const { return functions * single_components; }
  std::size_t batch() const { return params.method == EntryMethod::rays ? 1 : directions_per_step; }

  void set_places(const std::vector<SurfacePoint>& points);
  void advance_lamp();
  void advance_directions();
  void look_up(std::size_t place, const DepthLayers& map, const float* s, LitPath& lit) const;
  void trace(std::size_t place, Vec3 direction, const float* s, LitPath& lit) const;
  template <typename Body>
  void for_places(std::size_t first, std::size_t count, const Body& body);
};

void SingleTransportState::Impl::set_places(const std::vector<SurfacePoint>& points) {
  const Bounds3 box = bounds(*mesh);
  std::vector<Vec3> unordered;
  unordered.reserve(points.size());
  for (const SurfacePoint& point : points) unordered.push_back(point.position);
  order = order_places(unordered, box);
  positions.resize(points.size());
  inward.resize(points.size());
  path_mm.resize(points.size());
  parallel_for_blocks(points.size(), points_per_block, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const SurfacePoint& point = points[order[i]];
      positions[i] = point.position;
      inward[i] = -point.normal;
      path_mm[i] = static_cast<float>(find_path_length(point, inward[i], box, *tracer));
    }
  });
}

// Calls body(begin, end, nodes [place][2][nodes], lit, sums) over blocks of places.
template <typename Body>
void SingleTransportState::Impl::for_places(std::size_t first, std::size_t count,
                                            const Body& body) {
  parallel_for_blocks(count, points_per_block, [&](std::size_t begin, std::size_t end) {
    std::vector<float> paths(points_per_block * 2 * nodes), sums(4 * functions, 0.0f);
    for (std::size_t i = begin; i < end; ++i) {
      float* s = paths.data() + (i - begin) * 2 * nodes;
      make_path_nodes(static_cast<double>(path_mm[first + i]), static_cast<int>(nodes),
                      path_scale_mm, s, s + nodes);
    }
    body(first + begin, first + end, paths.data(), sums.data());
  });
}

void SingleTransportState::Impl::advance_lamp() {
  const std::size_t first = step * point_light_places;
  const std::size_t count = std::min(point_light_places, positions.size() - first);
  const BasisView basis = view_of(table);
  for_places(first, count, [&](std::size_t begin, std::size_t end, const float* s, float* sums) {
    LitPath lit;
    // Unlike directions, each node has its own irradiance; the lamp's colour is common to all.
    const PointLight white{.position = lamp->position};
    const float colour[3] = {lamp->intensity.x, lamp->intensity.y, lamp->intensity.z};
    for (std::size_t i = begin; i < end; ++i, s += 2 * nodes) {
      lit.count = 0;
      for (std::size_t k = 0; k < nodes; ++k) {
        const LightEntry entry =
            find_entry(positions[i] + inward[i] * s[k], white, *mesh, *tracer, eta);
        if (entry.reached) append_point(entry, s[k], s[nodes + k], lit);
      }
      deposit_path(basis, lit, colour, sums, value.data() + order[i] * row());
    }
  });
}

void SingleTransportState::Impl::look_up(std::size_t place, const DepthLayers& map, const float* s,
                                         LitPath& lit) const {
  const Vec3 p = positions[place], n = inward[place];
  const MapPath path{.x = dot(map.axis_x, p) + map.offset.x,
                     .y = dot(map.axis_y, p) + map.offset.y,
                     .z = dot(map.axis_z, p) + map.offset.z,
                     .dx = dot(map.axis_x, n),
                     .dy = dot(map.axis_y, n),
                     .dz = dot(map.axis_z, n)};
  look_up_path(map.texels.data(), map.width, map.height, bias_texels * map.texel_mm, path, s,
               s + nodes, nodes, &lit);
}

void SingleTransportState::Impl::trace(std::size_t place, Vec3 direction, const float* s,
                                       LitPath& lit) const {
  const LightDirection white{.direction = direction, .weight = {1, 1, 1}};
  lit.count = 0;
  for (std::size_t k = 0; k < nodes; ++k) {
    const LightEntry entry =
        find_entry(positions[place] + inward[place] * s[k], white, *mesh, *tracer, eta);
    if (entry.reached) append_point(entry, s[k], s[nodes + k], lit);
  }
}

void SingleTransportState::Impl::advance_directions() {
  const std::size_t first = step * batch(), count = std::min(batch(), directions.size() - first);
  const bool by_rays = params.method == EntryMethod::rays;
  if (!by_rays) {
    maps.resize(directions_per_step);
    parallel_for(count, [&](std::size_t d) {
      maps[d] = make_depth_layers(*mesh, directions[first + d].direction, params.resolution, eta,
                                  std::move(maps[d]));
    });
  }
  const BasisView basis = view_of(table);
  for_places(0, positions.size(),
             [&](std::size_t begin, std::size_t end, const float* paths, float* sums) {
               LitPath lit;
               for (std::size_t d = 0; d < count; ++d) {
                 const Rgb weight = directions[first + d].weight;
                 const float colour[3] = {weight.x, weight.y, weight.z};
                 for (std::size_t i = begin; i < end; ++i) {
                   const float* s = paths + (i - begin) * 2 * nodes;
                   if (by_rays)
                     trace(i, directions[first + d].direction, s, lit);
                   else
                     look_up(i, maps[d], s, lit);
                   deposit_path(basis, lit, colour, sums, value.data() + order[i] * row());
                 }
               }
             });
}

SingleTransportState::SingleTransportState(const SplineBasis& basis,
                                           const std::vector<SurfacePoint>& points,
                                           const Light& light, const TriangleMesh& mesh,
                                           const RayTracer& tracer, double eta,
                                           const SingleScatteringParams& params)
    : impl_(std::make_unique<Impl>()) {
  check(describe(const_cast<SingleScatteringParams&>(params)));
  PARIAN_CHECK(eta >= 1);
  PARIAN_CHECK_EQ(mesh.normals.size(), mesh.positions.size());
  Impl& state = *impl_;
  state.params = params;
  state.mesh = &mesh;
  state.tracer = &tracer;
  state.eta = static_cast<float>(eta);
  state.nodes = static_cast<std::size_t>((params.path_samples + 1) / 2 * 2);
  state.functions = basis.size();
  state.table = make_basis_table(basis);
  if (const auto* lamp = std::get_if<PointLight>(&light)) state.lamp = *lamp;
  state.directions = make_light_directions(light, params.directions, params.seed);
  state.set_places(points);
  state.value.assign(points.size() * state.row(), 0.0f);
  const std::size_t items = state.lamp ? points.size() : state.directions.size(),
                    batch = state.lamp ? point_light_places : state.batch();
  state.steps = (items + batch - 1) / batch;
}
SingleTransportState::~SingleTransportState() = default;
SingleTransportState::SingleTransportState(SingleTransportState&&) noexcept = default;
SingleTransportState& SingleTransportState::operator=(SingleTransportState&&) noexcept = default;

std::size_t SingleTransportState::steps() const {
  return impl_->steps;
}
std::size_t SingleTransportState::step() const {
  return impl_->step;
}
const std::vector<float>& SingleTransportState::value() const {
  return impl_->value;
}

void SingleTransportState::advance() {
  if (impl_->step >= impl_->steps) return;
  if (impl_->lamp)
    impl_->advance_lamp();
  else
    impl_->advance_directions();
  ++impl_->step;
}

void SingleTransportState::restore(std::size_t step, std::vector<float> value) {
  const auto refuse = [](std::string_view place, std::string expected, std::string found) {
    throw Error{{.file = {},
                 .place = std::string(place),
                 .expected = std::move(expected),
                 .found = std::move(found)}};
  };
  if (step > impl_->steps)
    refuse("step", fmt::format("at most {}", impl_->steps), std::to_string(step));
  if (value.size() != impl_->value.size())
    refuse("single scattering", fmt::format("{} values", impl_->value.size()),
           std::to_string(value.size()));
  for (const float x : value)
    if (!std::isfinite(x)) refuse("single scattering", "finite values", std::to_string(x));
  impl_->step = step;
  impl_->value = std::move(value);
}

std::vector<float> compute_single_transport(const SplineBasis& basis,
                                            const std::vector<SurfacePoint>& points,
                                            const Light& light, const TriangleMesh& mesh,
                                            const RayTracer& tracer, double eta,
                                            const SingleScatteringParams& params,
                                            const Progress& progress) {
  SingleTransportState state(basis, points, light, mesh, tracer, eta, params);
  constexpr std::string_view stage = "single scattering";
  while (state.step() < state.steps()) {
    advance_progress(progress, stage,
                     static_cast<double>(state.step()) / static_cast<double>(state.steps()));
    state.advance();
  }
  advance_progress(progress, stage, 1);
  return state.value();
}

}  // namespace parian
