#include "render/refinement.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

#include "base/parallel.h"
#include "base/stopwatch.h"
#include "mesh/closed.h"
#include "render/exitance_internal.h"
#include "render/shade_internal.h"
#include "transport/moment_tree.h"

namespace parian {
namespace {

// How a pass gathers. tolerance 0: by quality, and by every sample where that is 0, too.
struct Pass {
  double quality = 0;
  double tolerance = 0;
  bool is_exact() const { return quality == 0 && tolerance == 0; }
};

std::vector<Pass> plan_passes(const RefinementParams& params, bool has_tree, bool monotone) {
  std::vector<Pass> passes;
  if (has_tree) passes.push_back({params.render.quality, 0});
  double tolerance = params.first_tolerance;
  while (has_tree && monotone && tolerance >= RefinementParams::least_certified) {
    passes.push_back({params.render.quality, tolerance});
    if (tolerance <= params.tolerance) return passes;
    tolerance = std::max(tolerance / 2, params.tolerance);
  }
  passes.push_back({});
  return passes;
}

struct Tile {
  int x = 0, y = 0, width = 0, height = 0;
};

// Those nearest to the middle first.
std::vector<Tile> make_tiles(int width, int height, int side) {
  std::vector<Tile> tiles;
  for (int y = 0; y < height; y += side)
    for (int x = 0; x < width; x += side)
      tiles.push_back({x, y, std::min(side, width - x), std::min(side, height - y)});
  const auto distance2 = [&](const Tile& tile) {
    const double dx = tile.x + 0.5 * (tile.width - width);
    const double dy = tile.y + 0.5 * (tile.height - height);
    return dx * dx + dy * dy;
  };
  std::stable_sort(tiles.begin(), tiles.end(),
                   [&](const Tile& a, const Tile& b) { return distance2(a) < distance2(b); });
  return tiles;
}

// Where light is gathered, and with what.
struct Gatherer {
  std::optional<PlacedProfiles> profiles;
  std::optional<MomentTree> tree;
  std::optional<PlacedTable> table;
};

struct Gathered {
  std::vector<Rgb> exitance;
  std::vector<float> half_width;
};

template <typename Point>
std::vector<Point> pick(const std::vector<Point>& points,
                        const std::vector<std::uint32_t>& indices) {
  std::vector<Point> picked;
  picked.reserve(indices.size());
  for (const std::uint32_t i : indices) picked.push_back(points[i]);
  return picked;
}

Gathered gather(const Gatherer& gatherer, const SurfaceMaterial& material, const Pass& pass,
                const std::vector<std::uint32_t>& targets, const Progress& progress) {
  Gathered result;
  if (gatherer.table) {
    result.exitance =
        gather_table(std::get<BssrdfTable>(material), gatherer.table->sources,
                     pick(gatherer.table->targets, targets), gatherer.table->near_mm, progress);
    result.half_width.assign(targets.size(), 0.0f);
    return result;
  }
  const PlacedProfiles& placed = *gatherer.profiles;
  const std::vector<GatherPoint> points = pick(placed.targets, targets);
  if (pass.is_exact()) {
    result.exitance = gather_brute(placed.field, placed.sources, points, placed.near_mm, progress);
    result.half_width.assign(targets.size(), 0.0f);
    return result;
  }
  TreeGatherParams params;
  params.quality = pass.quality;
  params.tolerance = pass.tolerance;
  params.certify_every = 1;
  TreeGatherResult found = gatherer.tree->gather(points, placed.near_mm, params, progress);
  result.exitance = std::move(found.exitance);
  result.half_width = std::move(found.half_width);
  return result;
}

}  // namespace

ParamList describe(RefinementParams& params) {
  return {{.name = "first-tolerance",
           .help = "certified relative half-width of the second pass; it halves from pass to pass",
           .target = &params.first_tolerance,
           .min = 0.01,
           .max = 1},
          {.name = "tolerance",
           .help = "certified relative half-width of the last pass; below 0.1 every sample is "
                   "summed",
           .target = &params.tolerance,
           .min = 0,
           .max = 1},
          {.name = "tile",
           .help = "pixels of a tile's side",
           .target = &params.tile,
           .min = 1,
           .max = 1024}};
}

struct Refinement::Impl {
  Scene scene;
  RefinementParams params;
  RefinementReport report;
  Image image;
  std::vector<float> half_width;  // of pixels

  // Made in this order, each when the one before is there.
  std::optional<RayTracer> tracer;
  std::optional<SurfaceSamples> samples;
  std::optional<std::vector<Rgb>> flux;
  std::optional<PrimaryView> view;
  std::optional<Gatherer> gatherer;
  std::optional<std::vector<Rgb>> single;  // light scattered once, of each target; empty: none
  std::optional<PixelShader> shader;
  std::vector<std::string> mesh_warnings, single_warnings;

  std::vector<Rgb> exitance;      // of targets
  std::vector<float> of_targets;  // their half-widths
  std::vector<Pass> passes;
  std::vector<Tile> tiles;
  std::size_t pass = 0, tile = 0;

  void clear_picture();
  void forget_view();
  void forget_gatherer();
  bool prepare(const Progress& progress);
  void start();
  void refine(const Progress& progress);
  std::vector<std::uint32_t> list_targets(const Tile& at, double tolerance) const;
  void shade(const Tile& at);
  void report_brackets();
};

void Refinement::Impl::clear_picture() {
  const int width = scene.camera.width, height = scene.camera.height;
  image = make_image(width, height, 3);
  half_width.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height),
                    nothing_yet);
  report.pass = 0;
  report.done = 0;
  report.tolerance = 1;
  report.max_half_width = report.mean_half_width = -1;
}

void Refinement::Impl::forget_gatherer() {
  shader.reset();  // refers to the scene
  gatherer.reset();
  single.reset();
  clear_picture();
}

void Refinement::Impl::forget_view() {
  forget_gatherer();
  view.reset();
}

// One stage; false where all is there.
bool Refinement::Impl::prepare(const Progress& progress) {
  if (!tracer) {
    tracer.emplace(scene.mesh);
  } else if (!samples) {
    SurfaceSamples made = make_surface_samples(
        scene.mesh, static_cast<std::size_t>(params.render.samples), params.render.seed, progress);
    mesh_warnings.clear();
    check_closed(made, *tracer, scene.mesh_name, mesh_warnings);
    samples = std::move(made);
  } else if (!flux) {
    flux = compute_flux(scene, *tracer, *samples, params.render, progress);
  } else if (!view) {
    view = trace_primary(scene.mesh, *tracer, scene.camera, params.render.antialias, progress);
  } else if (!gatherer) {
    const GatherInput input{scene, *samples, view->targets};
    Gatherer made;
    if (const auto* table = std::get_if<BssrdfTable>(&scene.material)) {
      made.table = place_table(input, *table, *flux);
    } else {
      made.profiles = place_profiles(input, std::get<Material>(scene.material), *flux);
      made.tree.emplace(made.profiles->field, made.profiles->sources);
    }
    gatherer = std::move(made);
  } else if (!single) {
    single_warnings.clear();
    const Dipole* dipole = find_single_scattering(scene, single_warnings);
    single = dipole == nullptr || view->targets.empty()
                 ? std::vector<Rgb>{}
                 : compute_single_exitance({scene, *samples, view->targets}, *tracer, *dipole,
                                           params.render.seed, progress);
    start();
  } else {
    return false;
  }
  return true;
}

void Refinement::Impl::start() {
  exitance.assign(view->targets.size(), Rgb{});
  of_targets.assign(view->targets.size(), nothing_yet);
  shader.emplace(scene, *tracer, *view, exitance, params.render);
  passes = plan_passes(params, gatherer->tree.has_value(),
                       gatherer->profiles && gatherer->profiles->field.monotone);
  tiles = make_tiles(scene.camera.width, scene.camera.height, params.tile);
  pass = tile = 0;
  report.passes = static_cast<int>(passes.size());
  report.warnings = mesh_warnings;
  report.warnings.insert(report.warnings.end(), single_warnings.begin(), single_warnings.end());
  if (view->hits.empty()) report.warnings.emplace_back("the camera sees nothing of the mesh");
}

// Of a tile those whose half-width is not yet as small as wanted.
std::vector<std::uint32_t> Refinement::Impl::list_targets(const Tile& at, double tolerance) const {
  std::vector<std::uint32_t> targets;
  const auto width = static_cast<std::size_t>(scene.camera.width);
  for (int y = at.y; y < at.y + at.height; ++y) {
    const std::size_t row = static_cast<std::size_t>(y) * width + static_cast<std::size_t>(at.x);
    for (std::size_t i = view->begin[row];
         i < view->begin[row + static_cast<std::size_t>(at.width)]; ++i) {
      const std::uint32_t target = view->hits[i].target;
      if (of_targets[target] < 0 || static_cast<double>(of_targets[target]) > tolerance)
        targets.push_back(target);
    }
  }
  std::sort(targets.begin(), targets.end());
  targets.erase(std::unique(targets.begin(), targets.end()), targets.end());
  return targets;
}

void Refinement::Impl::shade(const Tile& at) {
  const auto width = static_cast<std::size_t>(scene.camera.width);
  parallel_for(static_cast<std::size_t>(at.height), [&](std::size_t row) {
    const std::size_t y = static_cast<std::size_t>(at.y) + row;
    for (std::size_t x = static_cast<std::size_t>(at.x);
         x < static_cast<std::size_t>(at.x + at.width); ++x) {
      const std::size_t pixel = y * width + x;
      const Rgb radiance = shader->shade(pixel);
      float* out = &image.values[3 * pixel];
      out[0] = radiance.x, out[1] = radiance.y, out[2] = radiance.z;
      float widest = 0;
      bool is_certified = true;
      for (std::size_t i = view->begin[pixel]; i < view->begin[pixel + 1]; ++i) {
        const float of_target = of_targets[view->hits[i].target];
        is_certified = is_certified && of_target >= 0;
        widest = std::max(widest, of_target);
      }
      half_width[pixel] = is_certified ? widest : no_bracket;
    }
  });
}

void Refinement::Impl::report_brackets() {
  report.max_half_width = report.mean_half_width = -1;
  double sum = 0, most = 0;
  for (const float width : of_targets) {
    if (width < 0) return;
    sum += static_cast<double>(width);
    most = std::max(most, static_cast<double>(width));
  }
  report.max_half_width = most;
  report.mean_half_width = of_targets.empty() ? 0 : sum / static_cast<double>(of_targets.size());
}

void Refinement::Impl::refine(const Progress& progress) {
  const Pass& now = passes[pass];
  report.pass = static_cast<int>(pass);
  report.tolerance = now.is_exact() ? 0 : now.tolerance > 0 ? now.tolerance : 1;
  const std::vector<std::uint32_t> targets =
      list_targets(tiles[tile], pass == 0 ? -1 : report.tolerance);
  if (!targets.empty()) {
    const Gathered found = gather(*gatherer, scene.material, now, targets, progress);
    for (std::size_t i = 0; i < targets.size(); ++i) {
      exitance[targets[i]] = found.exitance[i];
      if (!single->empty()) exitance[targets[i]] += (*single)[targets[i]];
      of_targets[targets[i]] = found.half_width[i];
    }
  }
  if (pass == 0 || !targets.empty()) shade(tiles[tile]);
  ++tile;
  report.done = static_cast<double>(tile) / static_cast<double>(tiles.size());
  if (tile < tiles.size()) return;
  report_brackets();
  ++pass;
  tile = 0;
}

Refinement::Refinement(Scene scene, const RefinementParams& params)
    : impl_(std::make_unique<Impl>()) {
  impl_->params = params;
  impl_->params.render.shading = Shading::pixel;
  check(describe(impl_->params));
  check(describe(impl_->params.render));
  check_layers(scene, scene.mesh_name);
  check_memory(estimate_memory(scene, impl_->params.render), 0,
               "fewer pixels, samples or rays per pixel need less");
  impl_->scene = std::move(scene);
  impl_->clear_picture();
}

Refinement::~Refinement() = default;
Refinement::Refinement(Refinement&&) noexcept = default;
Refinement& Refinement::operator=(Refinement&&) noexcept = default;

void Refinement::set_material(const SurfaceMaterial& material) {
  Impl& impl = *impl_;
  if (boundary_of(material) != boundary_of(impl.scene.material) ||
      eta_of(material) != eta_of(impl.scene.material))
    impl.flux.reset();
  impl.forget_gatherer();
  impl.scene.material = material;
}

void Refinement::set_material(const SurfaceMaterial& material,
                              const std::vector<SurfaceLayer>& layers) {
  Scene& scene = impl_->scene;
  std::vector<SurfaceLayer> old = std::exchange(scene.layers, layers);
  set_material(material);
  try {
    check_layers(scene, scene.mesh_name);
  } catch (...) {
    scene.layers = std::move(old);
    throw;
  }
}

void Refinement::set_lights(const std::vector<Light>& lights) {
  impl_->forget_gatherer();
  impl_->flux.reset();
  impl_->scene.lights = lights;
}

void Refinement::set_camera(const Camera& camera) {
  impl_->scene.camera = camera;
  impl_->forget_view();
}

void Refinement::set_exposure(double stops) {
  Impl& impl = *impl_;
  impl.scene.exposure = stops;
  if (!impl.shader) return;
  impl.shader.emplace(impl.scene, *impl.tracer, *impl.view, impl.exitance, impl.params.render);
  const std::size_t shaded = impl.pass == 0 ? impl.tile : impl.tiles.size();
  for (std::size_t i = 0; i < shaded; ++i) impl.shade(impl.tiles[i]);
}

bool Refinement::is_done() const {
  return impl_->single && impl_->pass == impl_->passes.size();
}

void Refinement::advance(const Progress& progress) {
  if (is_done()) return;
  Stopwatch watch;
  if (!impl_->prepare(progress)) impl_->refine(progress);
  impl_->report.seconds += watch.lap();
}

const Image& Refinement::image() const {
  return impl_->image;
}
const std::vector<float>& Refinement::half_width() const {
  return impl_->half_width;
}
const RefinementReport& Refinement::report() const {
  return impl_->report;
}

}  // namespace parian
