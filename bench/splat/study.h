// The studies behind docs/splatting.md, on the dragon under one directional light.
#pragma once

#include <string>

#include "bench/common/page.h"
#include "gl/context.h"
#include "material/material.h"
#include "scene/scene.h"

namespace parian {

// A sample material, fitted and compressed to two base materials per pixel. Those of data/samples
// are made in out/bench once.
struct SampleFiles {
  std::string map, blend;
};
SampleFiles make_sample_files(const std::string& sample);
// data/stone-72x64.h5.
const ProfileMap& stone_map();
const ProfileBlend& stone_blend();
Dipole make_marble();

// 80 mm long.
Scene make_dragon(const std::string& mesh_file, SurfaceMaterial material, int width, int height);

// Bare squares; then splats by number of samples.
void study_speed(const Page& page, const GlLimits& limits);
// One row per sample material: time and memory, as Table 3 of the 2019 paper.
void study_samples(const Page& page, const GlLimits& limits);
// What an edit costs at the interactive quality; homogeneous edits.
void study_edits(const Page& page, const GlLimits& limits);
void study_live(const Page& page, const GlLimits& limits);
void study_accuracy(const Page& page, const GlLimits& limits);
void study_pictures(const Page& page, const GlLimits& limits);

}  // namespace parian
