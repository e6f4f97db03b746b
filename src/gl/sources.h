// Emitters on the graphics device: the samples' profiles, and the moments of their groups.
#pragma once

#include <array>
#include <vector>

#include "gl/material_textures.h"
#include "gl/objects.h"
#include "gl/sample_levels.h"

namespace parian {

struct SourceLevel {
  int count = 0;
  int lines = 0;      // rows of texels that hold one value of each
  Texture positions;  // mm; of samples w has the packed normal
  Texture rows;       // [node][source]: exp(h) (level 0) or moments; after the last 1, or the flux
  std::vector<Texture> fit;  // shaders/fit_fragment.glsl
};

struct Sources {
  double area_mm2 = 0;
  std::vector<SourceLevel> levels;
  // Of the samples; `near`: the roots of the near term's integrals.
  Texture places, normals, flux, near;
};
struct SourcePrograms {
  Program sum_samples, sum_groups, centre_samples, centre_groups;
};
SourcePrograms make_source_programs();
// Of the material's kind.
Program make_rows_program(const MaterialTextures& material);

// Samples in their groups' order with their places in the material (pixels).
Sources make_sources(const std::vector<SurfacePoint>& samples, const std::vector<Vec2>& places,
                     double area_mm2, const RadialLevels& radial);
// After a change of the material: the samples' profiles.
void bake_profiles(Sources& sources, const Program& rows, const MaterialTextures& material);
// After a change of either: flux in W of each sample, and the groups' moments and places.
void set_flux(Sources& sources, const std::vector<Rgb>& flux);
void group_sources(Sources& sources, const SourcePrograms& programs);
// Sum over a level of its sources' flux, read back.
Rgb total_flux(const Sources& sources, int level);

}  // namespace parian
