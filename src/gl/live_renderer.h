// Homogeneous materials edited live with the graphics device (Xu et al. 2007, section 6.2): one
// pass over the vertices per edit, from transport that was computed before; the mesh is then drawn
// with it. The pictures are those of render/transport_renderer.h.
#pragma once

#include <memory>
#include <vector>

#include "base/params.h"
#include "gl/context.h"
#include "image/image.h"
#include "scene/scene.h"
#include "transport/homogeneous_transport.h"

namespace parian {

// Where an update sums transport: on the device, or, faster than a software rasteriser, on the CPU.
enum class LiveUpdate { automatic, device, cpu };

struct LiveParams {
  int antialias = 2;         // n x n pixels drawn per pixel
  int shadow_size = 2048;    // texels of a shadow map's side, for reflections
  int reflection_rays = 16;  // per pixel drawn and environment light
  LiveUpdate update = LiveUpdate::automatic;
};
ParamList describe(LiveParams& params);

struct LiveReport {
  double loading_s = 0;                                      // textures and programs, once
  double project_s = 0;                                      // of set_material
  double update_s = 0, view_s = 0, shade_s = 0, read_s = 0;  // of a picture
  std::size_t vertices = 0, triangles = 0, texture_bytes = 0;
  std::string device;
  std::vector<std::string> warnings;
};

// Needs the context that it was made in to be current.
class LiveRenderer {
 public:
  // `transport` is of the scene's mesh and lights (one entry for each) and of its material's eta.
  // It is copied, to where updates are made; the renderer does not refer to it afterwards. Throws
  // Error(resource) where textures exceed the device's limits.
  LiveRenderer(const GlLimits& limits, const Scene& scene, const HomogeneousTransport& transport,
               const LiveParams& params = {});
  ~LiveRenderer();
  LiveRenderer(LiveRenderer&&) noexcept;
  LiveRenderer& operator=(LiveRenderer&&) noexcept;

  // Each of these and then draw; what did not change is kept. The material's eta must be the
  // transport's.
  void set_material(const Dipole& material);
  // Any curves, from a projection of the same transport.
  void set_coefficients(const TransportCoefficients& coefficients);
  // Factors of the lights' colours, for scattered light and not for reflections.
  void set_light_scale(const std::vector<Rgb>& scale);
  // A light that was turned or moved, of the same kind, with its new transport
  // (transport/live_transport.h).
  void set_light(std::size_t index, const Light& light, const LightTransport& transport);
  void set_camera(const Camera& camera);
  void set_exposure(double stops);

  // Linear radiance times 2^exposure into a texture; read() copies it, averaged over the n x n
  // pixels. `timed`: waits after each stage and fills the report.
  void draw(bool timed = false);
  Image read();
  // Of the last picture: 1 where the mesh is seen by all n x n, 0 by none.
  const std::vector<float>& coverage() const;
  // Of all vertices as last drawn, before F_t(w_o).
  std::vector<Rgb> read_vertices() const;

  const LiveReport& report() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace parian
