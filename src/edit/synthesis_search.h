// The sample as patches are compared during synthesis, and the search for the places where a patch
// continues an overlap: the summed squared difference at every position, by Fourier transforms.
#pragma once

#include <cstddef>
#include <vector>

#include "base/aligned.h"
#include "edit/synthesis_seams.h"
#include "math/fft.h"

namespace parian {

// A few uncorrelated planes, [plane][y][x].
struct TextureSample {
  int width = 0, height = 0, planes = 0;
  std::vector<float> values;
  double variance = 0;  // of all planes together

  std::size_t pixels() const {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  }
  const float* plane(int index) const {
    return values.data() + static_cast<std::size_t>(index) * pixels();
  }
};

// Standardises the planes and takes the principal components that hold nearly all their variance,
// at most eight; planes that do not vary are ignored. Throws Error for values that are not finite.
TextureSample make_texture_sample(const std::vector<float>& planes, int plane_count, int width,
                                  int height);

class PatchSearch {
 public:
  // The sample must outlive the search.
  explicit PatchSearch(const TextureSample& sample);

  // What a patch's overlap should be, and 0 elsewhere: [plane][y][x] with the sample's size, the
  // patch in its upper left corner.
  std::vector<float>& wanted() { return wanted_; }
  // The squared difference of wanted() and the sample, summed over planes and overlap, for a patch
  // of width x height at each position: [y][x], (sample.width - width + 1) of them in a row.
  void run(int width, int height, const Overlap& overlap, std::vector<float>& difference);

 private:
  void fill_squares();
  double sum_squares(int x, int y, int width, int height) const;
  void correlate();

  const TextureSample& sample_;
  FftGrid grid_;
  std::size_t spectrum_size_ = 0;
  AlignedVector<float> spectra_, wanted_spectra_, sum_;
  std::vector<float> wanted_, correlation_;
  std::vector<double> squares_;  // summed-area table over all planes
};

}  // namespace parian
