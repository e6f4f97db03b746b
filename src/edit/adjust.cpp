#include "edit/adjust.h"

#include "base/check.h"
#include "base/parallel.h"

namespace parian {
namespace {

constexpr std::size_t block = 4096;

double of_channel(const std::vector<double>& values, int channel) {
  return values.size() == 1 ? values[0] : values[static_cast<std::size_t>(channel)];
}

bool is_all(const std::vector<double>& values, double neutral) {
  for (double value : values)
    if (value != neutral) return false;
  return true;
}

struct Affine {
  const std::vector<double>* scale;
  const std::vector<double>* offset;
  bool is_identity() const { return is_all(*scale, 1) && is_all(*offset, 0); }
};

// values' = scale values + offset, scale and offset interpolated by the masks.
Plane map_affinely(const EditState& state, const Plane& values, const std::vector<Affine>& maps,
                   const std::vector<Mask>& masks) {
  Plane mapped(values.size());
  const std::size_t pixels = state.pixels();
  parallel_for_blocks(values.size(), block, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const int channel = static_cast<int>(i / pixels);
      double scale = 1, offset = 0;
      for (std::size_t s = 0; s < maps.size(); ++s) {
        const auto w = static_cast<double>(masks[s].weight[i % pixels]);
        scale += w * (of_channel(*maps[s].scale, channel) - 1);
        offset += w * of_channel(*maps[s].offset, channel);
      }
      mapped[i] = scale * values[i] + offset;
    }
  });
  return mapped;
}

bool is_identity(const std::vector<Affine>& maps) {
  for (const Affine& map : maps)
    if (!map.is_identity()) return false;
  return true;
}

}  // namespace

ParamList describe(Adjust& adjust) {
  ParamList list{{.name = "albedo-scale",
                  .help = "factor on the albedo, for all channels or for each",
                  .target = &adjust.albedo_scale,
                  .min = 0,
                  .max = 1000},
                 {.name = "albedo-offset",
                  .help = "added to the albedo, for all channels or for each",
                  .target = &adjust.albedo_offset,
                  .min = -10,
                  .max = 10},
                 {.name = "range-scale",
                  .help = "factor on the scattering range",
                  .target = &adjust.range_scale,
                  .min = 0,
                  .max = 1000,
                  .above_min = true},
                 {.name = "range-offset-mm",
                  .help = "added to the scattering range",
                  .target = &adjust.range_offset_mm,
                  .min = -1000,
                  .max = 1000,
                  .unit = "mm"}};
  for (Param& param : describe(adjust.color)) list.push_back(std::move(param));
  return list;
}

void apply(const Adjust& adjust, EditState& state, const Mask& mask, EditReport& report) {
  apply(std::vector<Adjust>{adjust}, state, {mask}, report);
}

void apply(const std::vector<Adjust>& adjusts, EditState& state, const std::vector<Mask>& masks,
           EditReport& report) {
  PARIAN_CHECK_EQ(adjusts.size(), masks.size());
  std::vector<Affine> albedo, range;
  albedo.reserve(adjusts.size());
  range.reserve(adjusts.size());
  bool recolors = false;
  for (const Adjust& adjust : adjusts) {
    albedo.push_back({&adjust.albedo_scale, &adjust.albedo_offset});
    range.push_back({&adjust.range_scale, &adjust.range_offset_mm});
    recolors = recolors || !is_identity(adjust.color);
  }
  for (const Mask& mask : masks) PARIAN_CHECK_EQ(mask.weight.size(), state.pixels());
  if (!is_identity(albedo) || recolors) {
    const Plane before = albedo_plane(state);
    Plane after = is_identity(albedo) ? before : map_affinely(state, before, albedo, masks);
    for (std::size_t s = 0; recolors && s < adjusts.size(); ++s)
      if (!is_identity(adjusts[s].color))
        recolor_planes(after.data(), state.pixels(), adjusts[s].color, masks[s].weight.data());
    set_albedo(state, before, after, report);
  }
  if (!is_identity(range)) {
    const Plane before = range_plane(state);
    set_range(state, before, map_affinely(state, before, range, masks), report);
  }
}

}  // namespace parian
