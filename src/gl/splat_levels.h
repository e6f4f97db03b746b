// The camera pyramid and the splats into it.
#pragma once

#include <array>
#include <vector>

#include "gl/material_textures.h"
#include "gl/objects.h"
#include "gl/sources.h"
#include "gl/splat_fit.h"
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
  Texture sums;
  Texture near, mean;                            // of level 0
  std::vector<Texture> positions, depth, tiles;  // of each layer
  std::vector<Framebuffer> represent;            // of each layer
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

// Of splats (shaders/splat_fragment.glsl): of samples, with the mean around; of a level in which
// the reference ends; drawn as points; the same squares with nothing computed, for measuring.
struct SplatKind {
  bool is_single = false, with_mean = false, is_bounded = false, as_points = false, is_bare = false;
};
struct SplatPrograms {
  Program reduce_first, reduce, represent_pixels, represent, tiles;
  std::array<Program, 32> splat;  // see get_splat_program
  // Devices leave out what lies beyond a splat's reach; software rasterisers are faster without.
  bool on_software = false;
  float largest_point = 1;  // texels
};
SplatPrograms make_splat_programs(bool on_software);
// Made when it is first asked for.
const Program& get_splat_program(SplatPrograms& programs, SplatKind kind);

// After a change of camera: what every texel stands for.
void draw_pyramid(const ViewPyramid& pyramid, const SplatPrograms& programs,
                  const GeometryBuffer& geometry, const SplatCamera& camera);

// What all levels share.
struct SplatInput {
  const RadialLevels& radial;
  const ReferenceProfile& reference;
  const Vec4& near_kernel;
  NearRadii near;
  double max_support_mm;
};
// Nodes of some levels and the reference there.
void set_level_nodes(const Program& program, const SplatInput& input, int first, int count);
// Clears a level's targets and adds its emitters; `is_bare`: a constant in place of each.
void splat_level(const ViewPyramid& pyramid, SplatPrograms& programs, const Sources& sources,
                 const SplatInput& input, const SplatCamera& camera, int level,
                 bool is_bare = false);

}  // namespace parian
