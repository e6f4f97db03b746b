// A material as the shaders see it: profiles of its pixels at the renderer's radii.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "gl/objects.h"
#include "gl/sample_levels.h"
#include "material/profile_field.h"

namespace parian {

// One profile that stands for all of the material: the mean of h = 1/2 ln P over its pixels, up to
// the longest support. Splatting sums with it, and corrects by what profiles differ from it.
struct ReferenceProfile {
  std::vector<float> knots_mm;
  std::vector<Vec3> half_log;
  std::array<float, 3> support_mm{};
};
// h, also beyond the support.
Vec3 eval_reference(const ReferenceProfile& reference, double r_mm);
// A^2 = exp(2 h), 0 beyond the support.
std::array<double, 3> eval_reference_kernel(const ReferenceProfile& reference, double r_mm);
// h at node `index` of nodes, with the end of the support as shaders/material.glsl has it
// (cut_log).
Vec3 eval_reference_node(const ReferenceProfile& reference, const std::vector<float>& nodes,
                         std::size_t index);

struct MaterialTextures {
  std::vector<std::string> defines;  // for shaders with material.glsl
  int width = 1;
  int height = 1;
  double pixel_pitch_mm = 1;
  Boundary boundary = Boundary::excluded;
  double eta = 1.3;
  ReferenceProfile reference;
  std::vector<float> nodes;
  double end_mm = 0, least_slope = 0;  // of a blend's knots
  Texture support;
  Texture half_log;                   // of a map
  Texture base, index, weight, gain;  // of a blend
  bool is_sparse = false;             // somewhere too few samples carry the near term
  Texture near_integral, near_count;  // of the near term: ln I, n

  std::size_t bytes() const;
};
// Of the field, or of the blend that it is of, unless that is dilated. `area_mm2` of a sample sets
// the near term. Pixels of no support are left out.
MaterialTextures make_material_textures(const ProfileBlend* blend, const ProfileField& field,
                                        const RadialLevels& levels, double area_mm2,
                                        double near_mm);
// Everything material.glsl needs, from texture unit `unit` on; returns the next free unit.
int bind_material(const Program& program, const MaterialTextures& material, int unit);

}  // namespace parian
