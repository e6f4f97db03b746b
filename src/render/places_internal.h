// Samples and targets at their places in a scene's material.
#pragma once

#include <vector>

#include "material/profile_field.h"
#include "mesh/surface_samples.h"
#include "render/primary_internal.h"
#include "scene/scene.h"
#include "transport/gather.h"
#include "transport/gather_table.h"

namespace parian {

struct GatherInput {
  const Scene& scene;
  const SurfaceSamples& samples;
  const std::vector<MeshPlace>& targets;

  SurfacePoint get_target(std::size_t i) const;
};

struct PlacedProfiles {
  ProfileField field;  // of the material, or of the layers over it
  GatherSources sources;
  std::vector<GatherPoint> targets;
  double near_mm = 0;
};
// `flux` of each sample.
PlacedProfiles place_profiles(const GatherInput& input, const Material& material,
                              std::vector<Rgb> flux);

struct PlacedTable {
  TableGatherSources sources;
  std::vector<TableGatherPoint> targets;
  double near_mm = 0;
};
PlacedTable place_table(const GatherInput& input, const BssrdfTable& table, std::vector<Rgb> flux);

}  // namespace parian
