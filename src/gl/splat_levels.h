// The camera pyramid and the splats into it.
#pragma once

#include <vector>

#include "gl/material_textures.h"
#include "gl/objects.h"
#include "gl/sources.h"
#include "gl/surface_view.h"

namespace parian {

// The near term of level 0 (transport/near_term.h).
struct NearRadii {
  double near_mm = 0;
  double mean_mm = 0;
};

// Targets of one level: two layers, A and B of shaders/reduce_fragment.glsl; one where a texel is a
// pixel.
struct ViewLevel {
  int block = 1;  // pixels of a texel's side
  int layers = 1;
  Texture positions, sums;
  Texture near, mean;                  // of level 0
  std::vector<Texture> depth, tiles;   // of each layer
  std::vector<Framebuffer> represent;  // of each layer
  std::vector<Framebuffer> tile;
  std::vector<Framebuffer> splat;
};

struct ViewPyramid {
  int width = 0, height = 0;
  std::vector<Texture> representatives;  // of blocks of 2, 4, 8, ... pixels
  std::vector<ViewLevel> levels;
  std::size_t bytes() const;
};

// Sums in 32 bits, or in 16 where the device cannot; and what is summed.
struct SplatFormat {
  TexelFormat sums = TexelFormat::rgba32f;
  bool with_mean = true;  // the mean irradiance around texels, where samples are too few
};

// Sides of texels, in spacings of a level's emitters. Those of groups have to be small beside the
// lengths over which profiles fall, too, or dark parts far from light become coarse.
struct TexelSizes {
  double spacing_mm = 1;  // of the samples
  double samples = 0.75, groups = 0.3;
  double wanted_mm(int level) const;
};
// Texels of powers of two pixels.
ViewPyramid make_view_pyramid(const SplatCamera& camera, const RadialLevels& radial,
                              const TexelSizes& texels, SplatFormat format);

struct SplatProgram {
  Program points, squares;
};
struct SplatPrograms {
  Program reduce_first, reduce, represent_pixels, represent, tiles;
  SplatProgram single, single_mean, group;
  SplatProgram bare_single, bare_group;  // the same squares with nothing computed, for measuring
  float largest_point = 1;               // texels
};
// Devices leave out what lies beyond a splat's reach; software rasterisers are faster without.
SplatPrograms make_splat_programs(bool on_software);

// After a change of camera: what every texel stands for.
void draw_pyramid(const ViewPyramid& pyramid, const SplatPrograms& programs,
                  const GeometryBuffer& geometry, const SplatCamera& camera);

// Over r up to the end of level 0, for splat_fragment.glsl: the reference's kernel A^2, and the
// near term's over a plane.
Texture make_kernel_table(const RadialLevels& radial, const ReferenceProfile& reference,
                          double near_mm);

// What all levels share.
struct SplatInput {
  const RadialLevels& radial;
  const ReferenceProfile& reference;
  const Texture& kernel;
  NearRadii near;
  double max_support_mm;
};
// Nodes of some levels and the reference there.
void set_level_nodes(const Program& program, const SplatInput& input, int first, int count);
// Clears a level's targets and adds its emitters; `is_bare`: a constant in place of each.
void splat_level(const ViewPyramid& pyramid, const SplatPrograms& programs, const Sources& sources,
                 const SplatInput& input, const SplatCamera& camera, int level,
                 bool is_bare = false);

}  // namespace parian
