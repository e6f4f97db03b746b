// Pictures of a homogeneous material from precomputed transport: the view is traced once, each edit
// costs an update of the vertices and the shading.
#pragma once

#include <memory>
#include <vector>

#include "render/render.h"
#include "transport/homogeneous_transport.h"

namespace parian {

class TransportRenderer {
 public:
  // `transport` is of the scene's mesh and lights (one entry for each); both must outlive the
  // renderer. Of the parameters only antialias and seed are used: shading is by vertex.
  TransportRenderer(const Scene& scene, const HomogeneousTransport& transport,
                    const RenderParams& params = {}, const Progress& progress = {});
  ~TransportRenderer();
  TransportRenderer(TransportRenderer&&) noexcept;
  TransportRenderer& operator=(TransportRenderer&&) noexcept;

  // The material takes the place of the scene's; its eta must be the transport's. The report's
  // gather_s is the update of all vertices.
  RenderResult render(const Dipole& material, const Progress& progress = {}) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace parian
