// A new material from a photograph and a few profiles (SubEdit, section 7.1, "hallucination"): the
// photograph gives albedos, the profiles give ranges and shapes, propagated over pixels that look
// alike.
#pragma once

#include "base/params.h"
#include "base/progress.h"
#include "edit/edit_state.h"
#include "edit/mask_shapes.h"
#include "edit/propagate.h"
#include "image/image.h"

namespace parian {

struct HallucinateParams {
  std::vector<double> illumination{1};  // of the photograph: one value or one for each channel
  double pixel_pitch_mm = 0;            // of the photograph; 0: the map's
  int deblur = 0;  // steps C <- C photograph / relit, as the photograph is blurred by scattering
  double pin_radius_px = 2;
};
ParamList describe(HallucinateParams& params);

// A profile given to a place of the photograph.
struct Pin {
  std::uint32_t pixel = 0;  // of the photograph
  EditState profile;        // a map of one pixel; all on the same knots
};

inline constexpr std::size_t max_photograph_pixels = std::size_t{1} << 22u;

// The photograph's pixels become the map's. Ranges and shapes are those of the pins, weighted by
// propagation over Lab distances (delta E 1976) of `guidance`: the photograph itself or a picture
// of its size. 2 pi C = photograph / illumination. Boundary and eta are those of `like`. Throws
// Error for pictures of disagreeing sizes, values that are not finite, or none at all.
EditState hallucinate(const HallucinateParams& params, const PropagateParams& propagation,
                      const Image& photograph, const Image& guidance, const std::vector<Pin>& pins,
                      const EditState& like, EditReport& report, const Progress& progress = {});

}  // namespace parian
