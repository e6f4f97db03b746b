// The map seen flat: its properties, what is selected, and lit samples.
#pragma once

#include <memory>

#include "app/studio/studio.h"
#include "image/image.h"

namespace parian {

struct FlatRequest {
  EditState state;
  std::shared_ptr<const ProfileMap> map;
  std::shared_ptr<const Mask> mask;  // null: all is selected
  FlatMode mode = FlatMode::albedo;
  MapPixel beam;
};
// Of the map's size, 3 channels, linear. Ranges are in false colours up to the largest.
Image draw_flat(const FlatRequest& request, const Progress& progress);

// Values of all measured pairs in which a pixel takes part. Reads the channel's slices once.
std::vector<MeasuredPair> collect_pairs(const SliceSource& table, int channel, MapPixel pixel,
                                        const Progress& progress);

}  // namespace parian
