#include "gl/live_renderer.h"

#include <memory>
#include <string>

#include "base/check.h"
#include "base/stopwatch.h"
#include "gl/context.h"
#include "gl/shading.h"
#include "gl/transport_textures.h"

namespace parian {

ParamList describe(LiveParams& params) {
  return {describe_antialias(params.antialias),
          describe_shadow_size(params.shadow_size),
          describe_reflection_rays(params.reflection_rays),
          {.name = "live-update",
           .help = "where transport is summed: automatic is the CPU for software devices",
           .target = make_choice(params.update, {"automatic", "device", "cpu"})}};
}

namespace {

bool updates_on_cpu(LiveUpdate update, const std::string& renderer) {
  return update == LiveUpdate::automatic ? is_software(renderer) : update == LiveUpdate::cpu;
}

// What updates on the CPU need.
struct CpuTransport {
  HomogeneousTransport transport;
  std::vector<Vec3> positions, normals;
  TransportView view;
  std::vector<Rgb> radiance;
};

}  // namespace

struct LiveRenderer::Impl {
  Scene scene;  // its lights, exposure, background and specular
  LiveParams params;
  LiveReport report;
  TransportProjection projection;
  double eta = 1.3;
  bool has_single = false;

  MeshBuffers mesh;
  Program geometry_program;
  ShadingPrograms shading_programs;
  TransportTextures transport;
  TransportPrograms transport_programs;
  std::unique_ptr<CpuTransport> cpu;  // null: the device sums
  LightObjects lights;
  SelfOcclusion occlusion;
  SplatCamera camera;
  PictureTargets targets;

  TransportCoefficients coefficients;
  std::vector<Rgb> light_scale;
  bool vertices_are_old = true, view_is_old = true;

  explicit Impl(const HomogeneousTransport& made) : projection(made), eta(made.eta) {}
  void make_lights() {
    lights = make_light_objects(scene.lights, scene, mesh, params.shadow_size, false);
    targets.reflections_are_old = true;
  }
  void update_vertices();
  void draw_view();
  void draw_exitance();
  std::vector<float> coverage;
};

void LiveRenderer::Impl::update_vertices() {
  if (cpu == nullptr) {
    eval_transport(transport, transport_programs, coefficients, light_scale, camera.frame.position,
                   eta);
    return;
  }
  eval_transport(cpu->transport, coefficients, light_scale, cpu->view, cpu->radiance);
  put_radiance(transport, cpu->radiance);
}

void LiveRenderer::Impl::draw_view() {
  const int width = camera.frame.width, height = camera.frame.height;
  const Texture& old = targets.geometry.positions;
  if (old.width != width || old.height != height) targets = make_picture_targets(width, height);
  draw_geometry(targets.geometry, geometry_program, mesh, camera, scene.mapping, {1, 1, 1});
}

void LiveRenderer::Impl::draw_exitance() {
  const Program& program = transport_programs.surface;
  bind(targets.exitance_target);
  set_additive_blending(false);
  clear_color(0);
  clear_depth(1);  // the same again
  use(program);
  parian::set_camera(program, camera);
  bind_texture(program, "place_exitance", 0, transport.exitance);
  draw_mesh(mesh, camera.frame.position);
  check_gl("picture");
}

LiveRenderer::LiveRenderer(const GlLimits& limits, const Scene& scene,
                           const HomogeneousTransport& transport, const LiveParams& params)
    : impl_(std::make_unique<Impl>(transport)) {
  Stopwatch watch;
  LiveParams checked = params;
  check(describe(checked));
  PARIAN_CHECK_EQ(transport.places, scene.mesh.positions.size());
  PARIAN_CHECK_EQ(transport.lights.size(), scene.lights.size());
  Impl& impl = *impl_;
  impl.params = params;
  impl.scene.lights = scene.lights;
  impl.scene.exposure = scene.exposure;
  impl.scene.background = scene.background;
  impl.scene.show_environment = scene.show_environment;
  impl.scene.specular = scene.specular;
  impl.mesh = make_mesh_buffers(scene.mesh);
  impl.geometry_program = make_geometry_program();
  impl.shading_programs = make_shading_programs();
  const TexelFormat sums = limits.float_blend ? TexelFormat::rgba32f : TexelFormat::rgba16f;
  if (updates_on_cpu(params.update, limits.renderer)) {
    impl.cpu = std::make_unique<CpuTransport>(
        CpuTransport{transport, scene.mesh.positions, scene.mesh.normals, {}, {}});
    impl.transport = make_radiance_textures(transport.places, sums);
  } else {
    impl.transport =
        make_transport_textures(scene.mesh.positions, scene.mesh.normals, transport, sums);
  }
  impl.transport_programs = make_transport_programs(impl.transport);
  for (const LightTransport& light : transport.lights)
    impl.has_single = impl.has_single || light.single.functions > 0;
  impl.light_scale.assign(scene.lights.size(), Rgb{1, 1, 1});
  impl.make_lights();
  if (reflects_environments(impl.scene))
    impl.occlusion = make_self_occlusion(make_height_maps(scene.mesh));
  impl.report.vertices = transport.places;
  impl.report.triangles = scene.mesh.triangles.size();
  impl.report.texture_bytes = impl.transport.bytes();
  impl.report.device = limits.renderer;
  if (!limits.float_blend)
    impl.report.warnings.emplace_back("the graphics driver sums in 16 bits only");
  set_camera(scene.camera);
  finish_gl();
  impl.report.loading_s = watch.lap();
  if (const auto* material = std::get_if<Material>(&scene.material))
    if (const auto* dipole = std::get_if<Dipole>(material)) set_material(*dipole);
}

LiveRenderer::~LiveRenderer() = default;
LiveRenderer::LiveRenderer(LiveRenderer&&) noexcept = default;
LiveRenderer& LiveRenderer::operator=(LiveRenderer&&) noexcept = default;

void LiveRenderer::set_material(const Dipole& material) {
  PARIAN_CHECK_EQ(material.eta, impl_->eta);
  Stopwatch watch;
  set_coefficients(impl_->projection.fit(material));
  impl_->report.project_s = watch.lap();
}

void LiveRenderer::set_coefficients(const TransportCoefficients& coefficients) {
  impl_->coefficients = coefficients;
  impl_->vertices_are_old = true;
}

void LiveRenderer::set_light_scale(const std::vector<Rgb>& scale) {
  PARIAN_CHECK_EQ(scale.size(), impl_->light_scale.size());
  impl_->light_scale = scale;
  impl_->vertices_are_old = true;
}

void LiveRenderer::set_light(std::size_t index, const Light& light,
                             const LightTransport& transport) {
  Impl& impl = *impl_;
  PARIAN_CHECK(index < impl.scene.lights.size());
  PARIAN_CHECK_EQ(light.index(), impl.scene.lights[index].index());
  impl.scene.lights[index] = light;
  impl.make_lights();
  if (impl.cpu != nullptr)
    impl.cpu->transport.lights[index] = transport;
  else
    update_light(impl.transport, index, transport);
  impl.vertices_are_old = true;
}

void LiveRenderer::set_camera(const Camera& camera) {
  Impl& impl = *impl_;
  impl.camera = make_splat_camera(camera, impl.params.antialias, impl.mesh.box);
  impl.view_is_old = impl.targets.reflections_are_old = true;
  if (impl.cpu != nullptr && (impl.has_single || impl.cpu->view.value.empty()))
    impl.cpu->view =
        make_transport_view(impl.cpu->positions, impl.cpu->normals, impl.camera.frame.position,
                            impl.eta, /*has_fresnel=*/false);
  impl.vertices_are_old = impl.vertices_are_old || impl.has_single;
}

void LiveRenderer::set_exposure(double stops) {
  impl_->scene.exposure = stops;
}

void LiveRenderer::draw(bool timed) {
  Impl& impl = *impl_;
  PARIAN_CHECK(!impl.coefficients.multiple.empty());
  Stopwatch watch;
  const auto lap = [&] {
    if (timed) finish_gl();
    return watch.lap();
  };
  if (impl.vertices_are_old) impl.update_vertices();
  impl.report.update_s = lap();
  if (impl.view_is_old) impl.draw_view();
  if (impl.view_is_old || impl.vertices_are_old) impl.draw_exitance();
  impl.view_is_old = impl.vertices_are_old = false;
  impl.report.view_s = lap();
  shade(impl.targets, impl.shading_programs,
        {impl.scene, impl.camera, impl.lights, impl.occlusion, Boundary::excluded, impl.eta,
         impl.params.reflection_rays});
  impl.report.shade_s = lap();
}

Image LiveRenderer::read() {
  Stopwatch watch;
  Image image =
      read_picture(impl_->targets.radiance_target, impl_->params.antialias, impl_->coverage);
  impl_->report.read_s = watch.lap();
  return image;
}

const std::vector<float>& LiveRenderer::coverage() const {
  return impl_->coverage;
}

std::vector<Rgb> LiveRenderer::read_vertices() const {
  return read_radiance(impl_->transport);
}

const LiveReport& LiveRenderer::report() const {
  return impl_->report;
}

}  // namespace parian
