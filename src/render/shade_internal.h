// From exitance to radiance, and from hits to pixels.
#pragma once

#include <optional>
#include <vector>

#include "base/progress.h"
#include "image/image.h"
#include "render/primary_internal.h"
#include "render/render.h"
#include "render/specular_internal.h"

namespace parian {

// What pixels are shaded with. Scene, tracer, view and exitance must outlive it.
class PixelShader {
 public:
  // `exitance` is per target of the view, or per vertex with vertex shading.
  PixelShader(const Scene& scene, const RayTracer& tracer, const PrimaryView& view,
              const std::vector<Rgb>& exitance, const RenderParams& params);
  // Linear radiance times 2^exposure.
  Rgb shade(std::size_t pixel) const;

 private:
  Rgb exitance_at(const PrimaryHit& hit) const;
  Reflector make_reflector(const SurfacePoint& point, bool from_inside) const;
  Rgb shade_hit(const PrimaryHit& hit, Reflector seen, const PixelSequence& sequence,
                std::uint32_t rays) const;
  Rgb shade_hits(std::size_t pixel) const;
  Rgb shade_background(std::size_t pixel) const;

  const Scene& scene_;
  const PrimaryView& view_;
  const std::vector<Rgb>& exitance_;
  bool per_vertex_ = false;
  bool is_transmitting_ = false;  // Fresnel transmission towards the viewer
  float eta_ = 1.3f;              // of that
  float alpha_ = 0.1f;
  float exposure_ = 1;
  std::uint64_t seed_ = 1;
  std::optional<SpecularShader> specular_;
};

// The whole picture.
Image shade(const Scene& scene, const RayTracer& tracer, const PrimaryView& view,
            const std::vector<Rgb>& exitance, const RenderParams& params, const Progress& progress);

}  // namespace parian
