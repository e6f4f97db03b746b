// Reflection at a rough dielectric boundary: GGX with height-correlated Smith masking (Walter et
// al. 2007, Heitz 2014), visible normals sampled as in Heitz 2018.
#pragma once

#include <cstdint>
#include <vector>

#include "mesh/ray_tracer.h"
#include "scene/environment.h"

namespace parian {

// Where light is reflected, seen from `view` (unit, towards the viewer). Both normals are on the
// viewer's side.
struct Reflector {
  Vec3 position;
  Vec3 normal;            // dot(normal, view) > 0
  Vec3 geometric_normal;  // dot(geometric_normal, view) > 0
  Vec3 view;
  float alpha = 0.1f;
};

// Roughness of the distribution: roughness^2, not below the width that floats resolve.
float specular_alpha(double roughness);

// Reflected radiance per radiance from `light` and solid angle: F D G / (4 n.v n.l) times n.l.
float eval_ggx(float alpha, float eta, Vec3 normal, Vec3 view, Vec3 light);
// A direction with this pdf per solid angle; below the horizon where a facet reflects there.
Vec3 sample_ggx(float alpha, Vec3 normal, Vec3 view, Vec2 random);
float pdf_ggx(float alpha, Vec3 normal, Vec3 view, Vec3 light);

// The lights of a scene, ready to be reflected. The lights and the tracer must outlive it.
struct SpecularShader {
  SpecularShader(const std::vector<Light>& lights_, const RayTracer& tracer_, double eta_);

  const std::vector<Light>& lights;
  const RayTracer& tracer;
  float eta;
  std::vector<EnvironmentSampler> samplers;  // of the environment lights in order
};

// Numbers of one pixel: point i of `count` in [0,1)^2, shifted by the pixel's key.
struct PixelSequence {
  std::uint64_t key = 0;
  std::uint32_t count = 1;
};
Vec2 sample_2d(const PixelSequence& sequence, std::uint32_t i, std::uint64_t dimension);

// Radiance towards the viewer. Environments take rays first, ..., first + rays - 1 of the sequence,
// each once by the distribution of facets and once by brightness (balance heuristic).
Rgb eval_specular(const SpecularShader& shader, const Reflector& reflector,
                  const PixelSequence& sequence, std::uint32_t first, std::uint32_t rays);

}  // namespace parian
