// From codes to light: response curve, camera noise, dark frames, and exposures merged to one
// image. Values are in parts of full scale per second.
#pragma once

#include <vector>

#include "acquire/capture_meta.h"
#include "image/image.h"

namespace parian {

// Linear value at equidistant codes from 0 to 1, increasing from 0 to 1; empty: the code itself.
struct Response {
  std::vector<double> linear;
};
Response make_response(ResponseKind kind);  // recover counts as linear
double eval_response(const Response& response, double code);
// The code whose value is `linear`, both in [0, 1].
double invert_response(const Response& response, double linear);

// A pixel seen at two exposures; dark: the code of the dark frame there.
struct ExposurePair {
  double code_a = 0, dark_a = 0, seconds_a = 1;
  double code_b = 0, dark_b = 0, seconds_b = 1;
};
// The g with g(0) = 0 and g(1) = 1 for which (g(code) - g(dark)) / seconds agrees best (after
// Mitsunaga and Nayar 1999, known ratios of exposures), a sum of powers of the code from 1 to 4
// with coefficients >= 0: always increasing, and as curved as the encodings of cameras. Throws
// Error for fewer than 50 pairs.
Response recover_response(const std::vector<ExposurePair>& pairs);

// The variance of a linear value v in one frame is read^2 + v / full_well, in parts of full scale.
struct CameraNoise {
  double read = 0;
  double full_well = 1e4;
};
// From repeated frames (linear values, at least two of each): the dark ones give the read noise,
// the other ones the photons'. Only values below `saturation` count.
CameraNoise estimate_camera_noise(const std::vector<Image>& dark, const std::vector<Image>& light,
                                  double saturation);

// One exposure: the mean of repeated frames in linear values, and where any of them is saturated.
struct ExposureMean {
  Image value;
  std::vector<unsigned char> saturated;  // per value
  int frames = 0;
};
// Throws Error where sizes differ. `saturation` is a code.
ExposureMean average_frames(const std::vector<Image>& frames, const Response& response,
                            double saturation);

// Light without dark, with its variance; infinite variance: saturated at every exposure.
struct HdrImage {
  Image value;
  Image variance;
};
// Weights are inverse variances, predicted from a first merge (the sum of the unsaturated values
// over the sum of their seconds) and not from the values themselves, which would favour low ones.
HdrImage merge_exposures(const std::vector<ExposureMean>& light,
                         const std::vector<ExposureMean>& dark, const std::vector<double>& seconds,
                         const CameraNoise& noise);

// a - b with the sum of the variances.
HdrImage subtract(const HdrImage& a, const HdrImage& b);

}  // namespace parian
