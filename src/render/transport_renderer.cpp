#include "render/transport_renderer.h"

#include <numbers>

#include "base/check.h"
#include "render/exitance_internal.h"
#include "render/shade_internal.h"

namespace parian {

struct TransportRenderer::Impl {
  const Scene& scene;
  const HomogeneousTransport& transport;
  RenderParams params;
  RayTracer tracer;
  PrimaryView view;
  TransportView towards_eye;
  TransportProjection projection;
};

TransportRenderer::TransportRenderer(const Scene& scene, const HomogeneousTransport& transport,
                                     const RenderParams& params_, const Progress& progress) {
  RenderParams params = params_;
  check(describe(params));
  PARIAN_CHECK_EQ(transport.places, scene.mesh.positions.size());
  PARIAN_CHECK_EQ(transport.lights.size(), scene.lights.size());
  params.shading = Shading::vertex;
  RayTracer tracer(scene.mesh);
  PrimaryView view = trace_primary(scene.mesh, tracer, scene.camera, params.antialias, progress);
  impl_ =
      std::make_unique<Impl>(Impl{scene, transport, params, std::move(tracer), std::move(view),
                                  make_transport_view(scene.mesh.positions, scene.mesh.normals,
                                                      scene.camera.position, transport.eta, false),
                                  TransportProjection(transport)});
}

TransportRenderer::~TransportRenderer() = default;
TransportRenderer::TransportRenderer(TransportRenderer&&) noexcept = default;
TransportRenderer& TransportRenderer::operator=(TransportRenderer&&) noexcept = default;

RenderResult TransportRenderer::render(const Dipole& material, const Progress& progress) const {
  PARIAN_CHECK_EQ(material.eta, impl_->transport.eta);
  Stopwatch total, watch;
  RenderResult result;
  RenderReport& report = result.report;
  report.gather = "transport";
  report.triangles = impl_->scene.mesh.triangles.size();
  report.vertices = report.targets = impl_->scene.mesh.positions.size();
  std::vector<Rgb> exitance;
  eval_transport(impl_->transport, impl_->projection.fit(material),
                 std::vector<Rgb>(impl_->scene.lights.size(), Rgb{1, 1, 1}), impl_->towards_eye,
                 exitance);
  for (Rgb& value : exitance) value *= std::numbers::pi_v<float>;  // as shade divides by it
  report.gather_s = watch.lap();
  result.image = shade(impl_->scene, impl_->tracer, impl_->view, exitance, impl_->params, progress);
  report.shading_s = watch.lap();
  report.total_s = total.lap();
  return result;
}

}  // namespace parian
