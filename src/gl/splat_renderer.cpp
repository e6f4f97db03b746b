#include "gl/splat_renderer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.h"
#include "base/stopwatch.h"
#include "gl/splat_renderer_internal.h"
#include "mesh/closed.h"
#include "transport/gather.h"
#include "transport/irradiance.h"
#include "transport/near_term.h"

namespace parian {
namespace {

const Material& get_material(const Scene& scene) {
  if (const auto* material = std::get_if<Material>(&scene.material)) return *material;
  throw Error({scene.material_name,
               {},
               "a fitted or homogeneous material for splatting",
               "a table without a fit"},
              ErrorKind::usage);
}

bool is_same(const EnvironmentLight& a, const EnvironmentLight& b) {
  return a.rotation_deg == b.rotation_deg && a.scale == b.scale && a.image.width == b.image.width &&
         a.image.values == b.image.values;
}

std::vector<EnvironmentLight> find_environments(const std::vector<Light>& lights) {
  std::vector<EnvironmentLight> found;
  for (const Light& light : lights)
    if (const auto* environment = std::get_if<EnvironmentLight>(&light))
      found.push_back(*environment);
  return found;
}

}  // namespace

void SplatRenderer::Impl::make_programs() {
  flux_program = make_lamp_program({"fresnel.glsl", "lamp.glsl", "lamp_flux_fragment.glsl"});
  shading_programs = make_shading_programs();
  geometry_program = make_geometry_program();
  splat_programs = make_splat_programs(is_software(report.device));
  source_programs = make_source_programs();
  fit_programs = make_fit_programs();
}

void SplatRenderer::Impl::make_groups() {
  if (!groups_are_old) return;
  group_sources(sources, source_programs);
  fit_sources(sources, fit_programs, radial, material->reference);
  groups_are_old = false;
}

void SplatRenderer::Impl::make_samples(const Progress& progress) {
  const SurfaceSamples made = make_surface_samples(
      scene.mesh, static_cast<std::size_t>(params.samples), params.seed, progress);
  area_mm2 = made.area_mm2;
  near = {default_near_mm(area_mm2), near_mean_mm(area_mm2)};
  for (const std::uint32_t i : order_by_groups(made.points)) samples.push_back(made.points[i]);
  report.samples = samples.size();
  report.sample_spacing_mm = made.spacing_mm();
  report.area_mm2 = area_mm2 * static_cast<double>(samples.size());
  report.escaping_fraction = check_closed(made, *tracer, scene.mesh_name, report.warnings);
}

void SplatRenderer::Impl::trace_flux(const std::vector<Light>& lights, const Progress& progress) {
  IrradianceParams of_rays;
  of_rays.rays = params.rays;
  of_rays.seed = params.seed;
  flux = compute_irradiance(samples, lights, *tracer, material->boundary, material->eta, of_rays,
                            progress);
  for (Rgb& value : flux) value *= static_cast<float>(area_mm2);
}

void SplatRenderer::Impl::put_flux() {
  set_flux(sources, flux);
  groups_are_old = true;
  if (params.lights == LightMode::traced) return;
  const Framebuffer target = make_framebuffer({{&sources.flux}}, "flux of samples");
  bind(target);
  set_additive_blending(true);
  for (const Lamp& lamp : lit.lamps) {
    const Program& program = flux_program.of(lamp);
    use(program);
    bind_texture(program, "sample_positions", 0, sources.levels.front().positions);
    bind_texture(program, "sample_normals", 1, sources.normals);
    bind_lamp(program, lamp, 2);
    set_uniform(program, "is_transmitting", material->boundary == Boundary::excluded ? 1 : 0);
    set_uniform(program, "eta", static_cast<float>(material->eta));
    set_uniform(program, "area_mm2", static_cast<float>(area_mm2));
    draw_screen();
  }
  set_additive_blending(false);
  check_gl("flux of samples");
}

void SplatRenderer::Impl::make_view() {
  const int width = camera.frame.width, height = camera.frame.height;
  const GeometryBuffer& geometry = targets.geometry;
  if (geometry.positions.width != width || geometry.positions.height != height)
    targets = make_picture_targets(width, height);
  pyramid = make_view_pyramid(camera, radial, texel_sizes(), {format.sums, material->is_sparse});
  view_is_old = pyramid_is_drawn = false;
  report.blocks.clear();
  for (const ViewLevel& level : pyramid.levels) report.blocks.push_back(level.block);
  report.targets = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  report.texture_bytes = pyramid.bytes() + material->bytes();
  report.material_bytes = material->bytes();
  for (const SourceLevel& level : sources.levels)
    report.texture_bytes += byte_size(level.rows) + byte_size(level.positions);
}

// Levels first, ..., first + count - 1 into the picture: the first alone, or two that follow.
void SplatRenderer::Impl::resolve(int first, int count) {
  const MaterialTextures& seen = is_layered ? *of_pixels : *material;
  const Program& program = first == 0 ? programs.resolve_single : programs.resolve_group;
  const GeometryBuffer& geometry = targets.geometry;
  bind(targets.exitance_target);
  if (first == 0) clear_color(0);
  use(program);
  parian::set_camera(program, camera);
  bind_texture(program, "positions", 0, geometry.positions);
  bind_texture(program, "normals", 1, geometry.normals);
  bind_texture(program, "places", 2, geometry.places);
  int unit = 3;
  std::vector<int> blocks;
  std::vector<float> softness;
  for (int i = 0; i < (first == 0 ? 1 : 2); ++i) {
    const int level = first + std::min(i, count - 1);
    const ViewLevel& view = pyramid.levels[static_cast<std::size_t>(level)];
    const std::string name = fmt::format("level{}_", i);
    bind_texture(program, (name + "a").c_str(), unit++, view.positions.front());
    bind_texture(program, (name + "b").c_str(), unit++, view.positions.back());
    bind_texture(program, (name + "sums").c_str(), unit++, view.sums);
    blocks.push_back(view.block);
    softness.push_back(static_cast<float>(texel_sizes().wanted_mm(level)));
  }
  if (first == 0) {
    bind_texture(program, "level_near", unit++, pyramid.levels[0].near);
    if (material->is_sparse) bind_texture(program, "level_mean", unit++, pyramid.levels[0].mean);
  }
  bind_material(program, seen, unit);
  set_uniform(program, "level_count", count);
  set_uniform(program, "block", blocks);
  set_uniform(program, "softness", softness);
  set_level_nodes(program, input(), first, count);
  set_additive_blending(true);
  draw_screen_on_surface();
  set_additive_blending(false);
  check_gl("picture");
}

SplatRenderer::SplatRenderer(const GlLimits& limits, const Scene& scene, const SplatParams& params,
                             const Progress& progress)
    : impl_(std::make_unique<Impl>()) {
  SplatParams checked = params;
  check(describe(checked));
  Stopwatch watch;
  const Material& material = get_material(scene);
  check_layers(scene, scene.mesh_name);
  Impl& impl = *impl_;
  impl.params = params;
  impl.format.sums = limits.float_blend ? TexelFormat::rgba32f : TexelFormat::rgba16f;
  impl.report.device = limits.renderer;
  impl.scene = scene;
  impl.tracer = std::make_unique<RayTracer>(impl.scene.mesh);
  impl.mesh_buffers = make_mesh_buffers(impl.scene.mesh);
  impl.make_programs();
  if (!limits.float_blend)
    impl.report.warnings.emplace_back("the graphics driver sums in 16 bits only");
  const auto* dipole = std::get_if<Dipole>(&material);
  if (dipole != nullptr && dipole->single_scattering)
    impl.report.warnings.emplace_back("single scattering is left out by splatting");
  impl.make_samples(progress);
  impl.report.sampling_s = watch.lap();
  impl.set_material(material);
  set_lights(scene.lights, progress);
  set_camera(scene.camera);
}

SplatRenderer::~SplatRenderer() = default;
SplatRenderer::SplatRenderer(SplatRenderer&&) noexcept = default;
SplatRenderer& SplatRenderer::operator=(SplatRenderer&&) noexcept = default;

void SplatRenderer::set_material(const Material& material) {
  const Boundary boundary = impl_->material->boundary;
  const double eta = impl_->material->eta;
  impl_->set_material(material);
  if (impl_->material->boundary != boundary || impl_->material->eta != eta) {
    impl_->flux_is_kept = false;
    const std::vector<Light> lights = impl_->scene.lights;
    set_lights(lights);
  }
}

void SplatRenderer::set_material(const Material& material,
                                 const std::vector<SurfaceLayer>& layers) {
  for (std::size_t i = 0; i < layers.size(); ++i)
    check_layer(layers[i], material, {}, impl_->scene.mesh, impl_->scene.mesh_name,
                fmt::format("/layers/{}", i));
  impl_->scene.layers = layers;
  set_material(material);
}

void SplatRenderer::set_lights(const std::vector<Light>& lights, const Progress& progress) {
  Impl& impl = *impl_;
  Stopwatch watch;
  // The lights before stay whole when this is cancelled.
  LightObjects lit =
      make_light_objects(lights, impl.scene, impl.mesh_buffers, impl.params.shadow_size,
                         impl.params.lights == LightMode::mapped);
  if (impl.params.lights == LightMode::traced) {
    impl.trace_flux(lights, progress);
  } else {
    const auto old = find_environments(impl.scene.lights), next = find_environments(lights);
    if (!impl.flux_is_kept ||
        !std::equal(old.begin(), old.end(), next.begin(), next.end(), is_same))
      impl.trace_flux({next.begin(), next.end()}, progress);
    impl.flux_is_kept = true;
  }
  impl.lit = std::move(lit);
  impl.scene.lights = lights;
  impl.targets.reflections_are_old = true;
  if (impl.occlusion.heights.layers == 0 && reflects_environments(impl.scene))
    impl.occlusion = make_self_occlusion(make_height_maps(impl.scene.mesh));
  impl.put_flux();
  impl.report.irradiance_s = watch.lap();
}

void SplatRenderer::set_camera(const Camera& camera) {
  impl_->camera = make_splat_camera(camera, impl_->params.antialias, impl_->mesh_buffers.box);
  impl_->view_is_old = impl_->pixels_are_old = true;
  impl_->geometry_is_drawn = false;
  impl_->targets.reflections_are_old = true;
}

void SplatRenderer::set_exposure(double stops) {
  impl_->scene.exposure = stops;
}

void SplatRenderer::draw(bool timed, const Progress& progress) {
  Impl& impl = *impl_;
  Stopwatch watch;
  const auto lap = [&] {
    if (timed) finish_gl();
    return watch.lap();
  };
  if (impl.view_is_old) impl.make_view();
  impl.make_groups();
  impl.report.group_s = lap();
  if (!impl.geometry_is_drawn)
    draw_geometry(impl.targets.geometry, impl.geometry_program, impl.mesh_buffers, impl.camera,
                  impl.scene.mapping, impl.grid);
  if (!impl.geometry_is_drawn || !impl.pyramid_is_drawn)
    draw_pyramid(impl.pyramid, impl.splat_programs, impl.targets.geometry, impl.camera);
  impl.geometry_is_drawn = impl.pyramid_is_drawn = true;
  if (impl.pixels_are_old) impl.make_pixel_textures(progress);
  impl.report.view_s = lap();
  impl.report.splat_s = 0;
  impl.report.level_s.clear();
  for (int level = 0; level < impl.radial.count; ++level) {
    advance_progress(progress, "splatting",
                     static_cast<double>(level) / static_cast<double>(impl.radial.count));
    splat_level(impl.pyramid, impl.splat_programs, impl.sources, impl.input(), impl.camera, level);
    impl.report.level_s.push_back(lap());
    impl.report.splat_s += impl.report.level_s.back();
  }
  for (int level = 0; level < impl.radial.count; level += level == 0 ? 1 : 2)
    impl.resolve(level, level == 0 ? 1 : std::min(2, impl.radial.count - level));
  impl.report.resolve_s = lap();
  shade(impl.targets, impl.shading_programs, impl.shading_input());
  impl.report.shade_s = lap();
}

Image SplatRenderer::read() {
  Impl& impl = *impl_;
  Stopwatch watch;
  Image image = read_picture(impl.targets.radiance_target, impl.params.antialias, impl.coverage);
  impl.report.read_s = watch.lap();
  return image;
}

const std::vector<float>& SplatRenderer::coverage() const {
  return impl_->coverage;
}

double SplatRenderer::time_bare_splats() {
  Impl& impl = *impl_;
  finish_gl();
  Stopwatch watch;
  for (int level = 0; level < impl.radial.count; ++level)
    splat_level(impl.pyramid, impl.splat_programs, impl.sources, impl.input(), impl.camera, level,
                /*is_bare=*/true);
  finish_gl();
  return watch.lap();
}

Rgb SplatRenderer::level_flux(int level) const {
  impl_->make_groups();
  return total_flux(impl_->sources, level);
}

const SplatReport& SplatRenderer::report() const {
  return impl_->report;
}

}  // namespace parian
