#include "gl/splat_renderer.h"

#include <epoxy/gl.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "base/stopwatch.h"
#include "gl/shading.h"
#include "gl/splat_levels.h"
#include "mesh/closed.h"
#include "mesh/surface_samples.h"
#include "transport/gather.h"
#include "transport/irradiance.h"
#include "transport/near_term.h"

namespace parian {
namespace {

const Material& get_material(const Scene& scene) {
  if (!scene.layers.empty())
    throw Error({scene.mesh_name, "layers", "a scene without layers for splatting",
                 fmt::format("{}", scene.layers.size())},
                ErrorKind::usage);
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

Program make_resolve_program(const MaterialTextures& material, bool is_single) {
  std::vector<std::string> defines = material.defines;
  if (is_single) defines.emplace_back("SINGLE");
  if (is_single && material.is_sparse) defines.emplace_back("MEAN");
  return make_program({"screen_vertex.glsl"}, {"material.glsl", "resolve_fragment.glsl"}, defines);
}

}  // namespace

ParamList describe(SplatParams& params) {
  return {{.name = "samples",
           .help = "points of the surface at which light enters",
           .target = &params.samples,
           .min = 100,
           .max = 4'000'000},
          {.name = "rays",
           .help = "per sample and environment light",
           .target = &params.rays,
           .min = 2,
           .max = 65'536},
          {.name = "antialias",
           .help = "n x n pixels drawn per pixel",
           .target = &params.antialias,
           .min = 1,
           .max = 8,
           .symbol = "n"},
          {.name = "octave",
           .help = "radius of the first level in spacings of the samples",
           .target = &params.octave,
           .min = 2,
           .max = 1024},
          {.name = "overlap",
           .help = "octaves within which a level gives way to the next",
           .target = &params.overlap,
           .min = 0.1,
           .max = 1},
          {.name = "texel",
           .help = "size of a level's texels in spacings of its emitters",
           .target = &params.texel,
           .min = 0.125,
           .max = 4},
          {.name = "lights",
           .help = "how directional and point lights reach the surface: traced, or by shadow maps",
           .target = make_choice(params.lights, {"traced", "mapped"})},
          {.name = "shadow-size",
           .help = "texels of a shadow map's side",
           .target = &params.shadow_size,
           .min = 64,
           .max = 16'384},
          {.name = "reflection-rays",
           .help = "per pixel drawn and environment light",
           .target = &params.reflection_rays,
           .min = 1,
           .max = 1024},
          {.name = "seed", .help = "of samples and rays", .target = &params.seed}};
}

SplatParams make_interactive_params() {
  SplatParams params;
  params.samples = 4000;
  params.rays = 32;
  params.antialias = 1;
  params.lights = LightMode::mapped;
  params.shadow_size = 1024;
  params.reflection_rays = 4;
  return params;
}

struct SplatRenderer::Impl {
  Scene scene;  // without its mesh's vertices: what lights, material and camera need
  SplatParams params;
  SplatFormat format;
  SplatReport report;

  TriangleMesh mesh;
  std::unique_ptr<RayTracer> tracer;
  std::vector<SurfacePoint> samples;  // in groups
  double area_mm2 = 0;
  NearRadii near;

  MeshBuffers mesh_buffers;
  Program geometry_program;
  ShadingPrograms shading_programs;
  LampProgram flux_program;
  SplatPrograms splat_programs;

  double max_support_mm = 0;
  RadialLevels radial;
  std::unique_ptr<MaterialTextures> material;
  SourcePrograms source_programs;
  Program rows, resolve_single, resolve_group;  // of the material's kind
  std::vector<std::string> resolve_defines;  // what they were made with
  bool resolves_sparse = false;
  SplatTables tables;
  Sources sources;
  std::vector<Rgb> flux;  // traced: of all lights, or of environments alone
  LightObjects lit;
  bool flux_is_kept = false;
  bool groups_are_old = true;

  SplatCamera camera;
  PictureTargets targets;
  ViewPyramid pyramid;
  bool view_is_old = true;     // its textures
  bool view_is_drawn = false;  // geometry and pyramid
  std::vector<float> coverage;

  void make_samples(const Progress& progress);
  void set_material(const Material& material);
  void set_places();
  void make_material_programs();
  void trace_flux(const std::vector<Light>& lights, const Progress& progress);
  void put_flux();
  void make_view();
  void resolve(int level);
  SampleGrid grid() const { return {material->width, material->height, material->pixel_pitch_mm}; }
  ShadingInput shading_input() const {
    return {scene, camera, lit, material->boundary, material->eta, params.reflection_rays};
  }
  SplatInput input() const { return {radial, material->reference, tables, near, max_support_mm}; }
};

void SplatRenderer::Impl::make_samples(const Progress& progress) {
  const SurfaceSamples made =
      make_surface_samples(mesh, static_cast<std::size_t>(params.samples), params.seed, progress);
  area_mm2 = made.area_mm2;
  near = {default_near_mm(area_mm2), near_mean_mm(area_mm2)};
  for (const std::uint32_t i : order_by_groups(made.points)) samples.push_back(made.points[i]);
  report.samples = samples.size();
  report.sample_spacing_mm = made.spacing_mm();
  report.area_mm2 = area_mm2 * static_cast<double>(samples.size());
  report.escaping_fraction = check_closed(made, *tracer, scene.mesh_name, report.warnings);
}

void SplatRenderer::Impl::set_material(const Material& next) {
  Stopwatch watch;
  const ProfileField field = make_profile_field(next);
  const bool same_boundary =
      material != nullptr && material->boundary == field.boundary && material->eta == field.eta;
  const SampleGrid old_grid = material != nullptr ? grid() : SampleGrid{0, 0, 0};
  const bool was_sparse = material != nullptr && material->is_sparse;
  const int old_levels = radial.count;
  max_support_mm = static_cast<double>(field.max_support_mm);
  radial = make_radial_levels(params.octave * std::sqrt(area_mm2), params.overlap, max_support_mm);
  material = std::make_unique<MaterialTextures>(
      make_material_textures(next, field, radial, area_mm2, near.near_mm));
  tables = make_splat_tables(radial, material->reference, near);
  const SampleGrid next_grid = grid();
  const bool same_grid = old_grid.width == next_grid.width && old_grid.height == next_grid.height &&
                         old_grid.pixel_pitch_mm == next_grid.pixel_pitch_mm;
  const bool same_levels = same_boundary && radial.count == old_levels;
  if (!same_grid || !same_levels) set_places();
  if (same_boundary) put_flux();
  make_material_programs();
  bake_profiles(sources, rows, *material);
  groups_are_old = true;
  view_is_drawn = view_is_drawn && same_grid;
  view_is_old = view_is_old || !same_levels || material->is_sparse != was_sparse;
  report.material_s = watch.lap();
  report.levels = radial.count;
  report.splats = 0;
  for (const SourceLevel& level : sources.levels)
    report.splats += static_cast<std::size_t>(level.count);
}

// Where the samples lie in the material.
void SplatRenderer::Impl::set_places() {
  std::vector<Vec2> places(samples.size());
  parallel_for_blocks(samples.size(), 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const SamplePoint place = map_to_sample(scene.mapping, grid(), samples[i]);
      places[i] = {static_cast<float>(place.x), static_cast<float>(place.y)};
    }
  });
  sources = make_sources(samples, places, area_mm2, radial);
}

void SplatRenderer::Impl::make_material_programs() {
  if (resolve_defines == material->defines && resolves_sparse == material->is_sparse) return;
  rows = make_rows_program(*material);
  resolve_single = make_resolve_program(*material, true);
  resolve_group = make_resolve_program(*material, false);
  resolve_defines = material->defines;
  resolves_sparse = material->is_sparse;
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
  pyramid = make_view_pyramid(camera, radial, std::sqrt(area_mm2), params.texel,
                              {format.sums, material->is_sparse});
  view_is_old = view_is_drawn = false;
  report.blocks.clear();
  for (const ViewLevel& level : pyramid.levels) report.blocks.push_back(level.block);
  report.targets = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  report.texture_bytes = pyramid.bytes() + material->bytes();
  for (const SourceLevel& level : sources.levels)
    report.texture_bytes += byte_size(level.rows) + byte_size(level.positions);
}

void SplatRenderer::Impl::resolve(int level) {
  const auto l = static_cast<std::size_t>(level);
  const ViewLevel& view = pyramid.levels[l];
  const Program& program = level == 0 ? resolve_single : resolve_group;
  const GeometryBuffer& geometry = targets.geometry;
  bind(targets.exitance_target);
  if (level == 0) clear_color(0);
  use(program);
  bind_texture(program, "positions", 0, geometry.positions);
  bind_texture(program, "normals", 1, geometry.normals);
  bind_texture(program, "places", 2, geometry.places);
  bind_texture(program, "level_positions", 3, view.positions);
  bind_texture(program, "level_sums", 4, view.sums);
  int unit = 5;
  if (level == 0) {
    set_uniform(program, "near_r", static_cast<float>(tables.near_mm));
    bind_texture(program, "level_normals", unit++, view.normals);
    bind_texture(program, "level_near", unit++, view.near);
    if (material->is_sparse) {
      bind_texture(program, "level_mean", unit++, view.mean);
      bind_texture(program, "near_integral", unit++, material->near_integral);
    }
    bind_texture(program, "near_count", unit++, material->near_count);
  }
  bind_material(program, *material, unit);
  set_uniform(program, "block", view.block);
  set_uniform(program, "softness",
              static_cast<float>(0.7 * params.texel * std::ldexp(std::sqrt(area_mm2), level)));
  set_level_nodes(program, input(), level);
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
  Impl& impl = *impl_;
  impl.params = params;
  impl.format.sums = limits.float_blend ? TexelFormat::rgba32f : TexelFormat::rgba16f;
  impl.report.device = limits.renderer;
  impl.mesh = scene.mesh;
  impl.scene.mesh_name = scene.mesh_name;
  impl.scene.mapping = scene.mapping;
  impl.scene.exposure = scene.exposure;
  impl.scene.background = scene.background;
  impl.scene.show_environment = scene.show_environment;
  impl.scene.specular = scene.specular;
  impl.flux_program = make_lamp_program({"fresnel.glsl", "lamp.glsl", "lamp_flux_fragment.glsl"});
  impl.shading_programs = make_shading_programs();
  impl.tracer = std::make_unique<RayTracer>(impl.mesh);
  impl.mesh_buffers = make_mesh_buffers(impl.mesh);
  impl.geometry_program = make_geometry_program();
  impl.splat_programs = make_splat_programs();
  impl.source_programs = make_source_programs();
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

void SplatRenderer::set_lights(const std::vector<Light>& lights, const Progress& progress) {
  Impl& impl = *impl_;
  Stopwatch watch;
  impl.lit = make_light_objects(lights, impl.scene, impl.mesh_buffers, impl.params.shadow_size,
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
  impl.scene.lights = lights;
  impl.put_flux();
  impl.report.irradiance_s = watch.lap();
}

void SplatRenderer::set_camera(const Camera& camera) {
  impl_->camera = make_splat_camera(camera, impl_->params.antialias, impl_->mesh_buffers.box);
  impl_->view_is_old = true;
}

void SplatRenderer::draw(bool timed, const Progress& progress) {
  Impl& impl = *impl_;
  Stopwatch watch;
  const auto lap = [&] {
    if (timed) finish_gl();
    return watch.lap();
  };
  if (impl.view_is_old) impl.make_view();
  if (impl.groups_are_old) group_sources(impl.sources, impl.source_programs);
  impl.groups_are_old = false;
  impl.report.group_s = lap();
  if (!impl.view_is_drawn) {
    draw_geometry(impl.targets.geometry, impl.geometry_program, impl.mesh_buffers, impl.camera,
                  impl.scene.mapping, impl.grid());
    draw_pyramid(impl.pyramid, impl.splat_programs, impl.targets.geometry, impl.camera);
    impl.view_is_drawn = true;
  }
  impl.report.view_s = lap();
  impl.report.splat_s = impl.report.resolve_s = 0;
  impl.report.level_s.clear();
  for (int level = 0; level < impl.radial.count; ++level) {
    advance_progress(progress, "splatting",
                     static_cast<double>(level) / static_cast<double>(impl.radial.count));
    splat_level(impl.pyramid, impl.splat_programs, impl.sources, impl.input(), impl.camera, level);
    impl.report.level_s.push_back(lap());
    impl.report.splat_s += impl.report.level_s.back();
    impl.resolve(level);
    impl.report.resolve_s += lap();
  }
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

Rgb SplatRenderer::level_flux(int level) const {
  if (impl_->groups_are_old) group_sources(impl_->sources, impl_->source_programs);
  impl_->groups_are_old = false;
  return total_flux(impl_->sources, level);
}

const SplatReport& SplatRenderer::report() const {
  return impl_->report;
}

}  // namespace parian
