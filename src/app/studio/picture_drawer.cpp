#include "app/studio/picture_drawer.h"

#include <cmath>
#include <optional>
#include <utility>

#include "app/studio/property_picture.h"
#include "base/error.h"
#include "render/render.h"

namespace parian {
namespace {

constexpr double difference_gain = 4;  // of the difference mode
constexpr int fine_samples = 16000;    // where light enters, at rest

// Splatting of one stage; remade for another one.
struct Splatter {
  std::shared_ptr<const Stage> stage;
  std::shared_ptr<const Material> material;
  StageLayers layers;
  Lighting lighting;
  Camera camera;
  std::unique_ptr<SplatRenderer> renderer;
};

// The same from precomputed transport.
struct Live {
  std::shared_ptr<const ReadyTransport> ready;
  std::shared_ptr<const Material> material;
  Lighting lighting;
  Camera camera;
  std::unique_ptr<LiveRenderer> renderer;
};

SplatParams splat_params(bool fine) {
  SplatParams params = make_interactive_params();
  if (fine) params.samples = fine_samples;
  return params;
}

RenderParams cpu_params(bool fine) {
  RenderParams params;
  params.samples = fine ? 50000 : 4000;
  params.rays = fine ? 64 : 16;
  params.antialias = fine ? 2 : 1;
  params.quality = fine ? 0.002 : 0.02;
  params.shading = fine ? Shading::pixel : Shading::vertex;
  return params;
}

Image splat(Splatter& splatter, const GlLimits& limits, const PictureRequest& request,
            const std::shared_ptr<const Material>& material, const Progress& progress) {
  if (splatter.renderer == nullptr || splatter.stage != request.stage) {
    splatter.renderer.reset();
    splatter.renderer = std::make_unique<SplatRenderer>(
        limits,
        make_scene(*request.stage, *material, request.layers, request.lighting, request.camera),
        splat_params(request.fine), progress);
    splatter.stage = request.stage;
  } else {
    if (splatter.layers != request.layers)
      splatter.renderer->set_material(*material, copy_layers(request.layers));
    else if (splatter.material != material)
      splatter.renderer->set_material(*material);
    splatter.material = material;
    splatter.layers = request.layers;
    if (!(splatter.lighting == request.lighting))
      splatter.renderer->set_lights(make_lights(request.lighting), progress);
    if (!(splatter.camera == request.camera)) splatter.renderer->set_camera(request.camera);
  }
  splatter.camera = request.camera;
  splatter.material = material;
  splatter.layers = request.layers;
  splatter.lighting = request.lighting;
  splatter.renderer->set_exposure(request.exposure);
  splatter.renderer->draw(true, progress);
  return splatter.renderer->read();
}

// `lighting` is that of the transport but for its brightness.
void set_brightness(Live& live, const PictureRequest& request) {
  const std::vector<Light> lights = make_lights(request.lighting);
  for (std::size_t i = 0; i < lights.size(); ++i)
    live.renderer->set_light(i, lights[i], live.ready->transport->lights[i]);
  live.renderer->set_light_scale(request.light_scales);
  live.lighting = request.lighting;
}

Image draw_live(Live& live, const GlLimits& limits, const PictureRequest& request) {
  if (live.renderer == nullptr || live.ready != request.transport) {
    live = {.ready = request.transport,
            .material = request.material,
            .lighting = request.transport->key.lighting,
            .camera = request.camera,
            .renderer = nullptr};
    LiveParams params;
    if (!request.fine) params = {.antialias = 1, .shadow_size = 1024, .reflection_rays = 4};
    live.renderer = std::make_unique<LiveRenderer>(
        limits, make_scene(*request.stage, *request.material, {}, live.lighting, request.camera),
        *live.ready->transport, params);
  }
  if (live.material != request.material) {
    live.renderer->set_material(std::get<Dipole>(*request.material));
    live.material = request.material;
  }
  if (!(live.camera == request.camera)) {
    live.renderer->set_camera(request.camera);
    live.camera = request.camera;
  }
  if (!(live.lighting == request.lighting)) set_brightness(live, request);
  live.renderer->set_exposure(request.exposure);
  live.renderer->draw(true);
  return live.renderer->read();
}

Image difference_of(Image after, const Image& before) {
  for (std::size_t i = 0; i < after.values.size(); ++i)
    after.values[i] =
        static_cast<float>(difference_gain) * std::abs(after.values[i] - before.values[i]);
  return after;
}

}  // namespace

struct PictureDrawer::Impl {
  std::optional<OffscreenContext> context;  // before what lives in it
  Splatter coarse, fine;
  Live live_coarse, live_fine;
  bool is_cpu_only = false;
  std::string warning;

  // Why the device does not do.
  void leave_device(const Error& error) {
    warning = std::string(error.what()) + "; pictures come from the processor now, which is slower";
    is_cpu_only = true;
  }
  Image shade(const PictureRequest& request, const std::shared_ptr<const Material>& material,
              const Progress& progress, Picture& picture);
  Image shade_on_device(const PictureRequest& request,
                        const std::shared_ptr<const Material>& material, const Progress& progress,
                        Picture& picture);
};

Image PictureDrawer::Impl::shade_on_device(const PictureRequest& request,
                                           const std::shared_ptr<const Material>& material,
                                           const Progress& progress, Picture& picture) {
  if (!context) context.emplace();
  if (request.transport != nullptr && std::holds_alternative<Dipole>(*material)) {
    Live& live = request.fine ? live_fine : live_coarse;
    Image image = draw_live(live, context->limits(), request);
    picture.live = live.renderer->report();
    picture.is_live = true;
    return image;
  }
  Splatter& splatter = request.fine ? fine : coarse;
  Image image = splat(splatter, context->limits(), request, material, progress);
  picture.report = splatter.renderer->report();
  return image;
}

Image PictureDrawer::Impl::shade(const PictureRequest& request,
                                 const std::shared_ptr<const Material>& material,
                                 const Progress& progress, Picture& picture) {
  if (!is_cpu_only) {
    try {
      return shade_on_device(request, material, progress, picture);
    } catch (const Error& error) {
      if (error.kind != ErrorKind::resource) throw;
      leave_device(error);
    }
  }
  Scene scene =
      make_scene(*request.stage, *material, request.layers, request.lighting, request.camera);
  scene.exposure = request.exposure;
  const RenderResult result = render(scene, cpu_params(request.fine), progress);
  picture.report = {};
  picture.report.samples = result.report.samples;
  picture.report.shade_s = result.report.total_s;
  picture.report.device = "the processor, without a graphics device";
  return result.image;
}

PictureDrawer::PictureDrawer() : impl_(std::make_unique<Impl>()) {}
PictureDrawer::~PictureDrawer() {
  reset();
}

void PictureDrawer::reset() {
  impl_->coarse = {};
  impl_->fine = {};
  impl_->live_coarse = {};
  impl_->live_fine = {};
}

std::string PictureDrawer::take_warning() {
  return std::exchange(impl_->warning, {});
}

Image PictureDrawer::draw(const PictureRequest& request, const Progress& progress,
                          Picture& picture) {
  Image image;
  switch (request.mode) {
    case ViewMode::difference:
      if (request.before != nullptr) {
        const Image before = impl_->shade(request, request.before, progress, picture);
        image = difference_of(impl_->shade(request, request.material, progress, picture), before);
        break;
      }
      [[fallthrough]];
    case ViewMode::shaded:
    case ViewMode::wireframe:
      image = impl_->shade(request, request.material, progress, picture);
      break;
    case ViewMode::albedo:
    case ViewMode::range:
      image = draw_property(*request.stage, *request.material, request.layers, request.camera,
                            request.mode == ViewMode::albedo);
      image = scale(std::move(image), std::exp2(static_cast<float>(request.exposure)));
      break;
    case ViewMode::irradiance:
      image = draw_irradiance(*request.stage, *request.material, make_lights(request.lighting),
                              request.camera);
      image = scale(std::move(image), std::exp2(static_cast<float>(request.exposure)));
      break;
  }
  if (request.mode == ViewMode::wireframe) draw_wireframe(*request.stage, request.camera, image);
  if (request.mask != nullptr && !request.mask->weight.empty())
    draw_mask(*request.stage, *request.material, *request.mask, request.camera, image);
  if (request.layer_mask != nullptr)
    draw_mask(*request.stage, request.layer_mask->mask, request.camera, image);
  return image;
}

}  // namespace parian
