// Virtual samples: base materials, a layout that mixes them over the plane, and a grid. Simulated,
// not measured: every table made from one says so in its provenance.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "acquire/layout.h"
#include "base/document.h"
#include "image/image.h"
#include "material/dipole.h"
#include "material/slices.h"

namespace parian {

struct SampleMaterial {
  std::string name;
  std::array<DipoleCoefficients, 3> channels;
  std::array<double, 3> g{};  // mean cosine of scattering; sigma_s = sigma_s_prime / (1 - g)
  std::optional<double> eta;  // of measured materials
};

// Continuous noise on the coefficients: factors e^{s n - s^2/2} of mean 1.
struct SampleVariation {
  double relative = 0;
  double length_mm = 2;
  int octaves = 3;
};

// What the photon engine needs beside the plane: how the sample goes on below it and around it.
struct SampleDepth {
  double thickness_mm = 0;  // 0: half-infinite
  double grid_mm = 0;       // of voxels in a half-infinite sample; 0: as deep as needed
  int voxels_per_pixel = 1;
  int margin_px = 8;  // of the layout around the sample; what is next to it goes on beyond
  double tilt_deg = 0;
  double tilt_direction_deg = 0;
  bool solid = false;
};
ParamList describe(SampleDepth& depth);

// Coefficients of every pixel, made from a description. Values count as points at pixel centres,
// bilinear between them.
struct Sample {
  std::string name;
  int width = 0;
  int height = 0;
  int channels = 3;  // 1, or 3: linear Rec. 709
  double pixel_pitch_mm = 1;
  double radius_px = 1;  // offsets of its tables: |d| <= radius_px
  double eta = 1.3;
  std::uint64_t seed = 1;
  std::vector<float> sigma_a;        // [channel][y][x], 1/mm
  std::vector<float> sigma_s_prime;  // [channel][y][x], 1/mm, > 0
  Document description;              // with the seed that was used
  // What they were made of, for volumes (photon_volume.h).
  std::vector<SampleMaterial> materials;
  Layout layout;
  SampleVariation variation;
  SampleDepth depth;

  std::size_t pixels() const {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  }
};

// Reads and checks a description (docs/samples.md, data/schema/sample.schema.json). Errors name
// file and JSON pointer. `seed` replaces the description's when it is not negative.
Sample read_sample(const Document& document, const ImageLoader& load_image, std::int64_t seed = -1);

// One field for sigma_a and one for sigma_s, the same for all channels: factors at a point of the
// plane, or with `solid` in space. Lengths in mm.
struct VariationFactors {
  double sigma_a = 1, sigma_s = 1;
};
VariationFactors eval_variation(const Sample& sample, double x, double y, double z);

// The header of a table of the sample, which both engines share: all offsets within radius_px that
// fit into its grid, one of each pair of directions. Errors name the sample.
TableHeader make_table_header(const Sample& sample, Boundary boundary, Sampling sampling,
                              const std::string& provenance);

// The table of the analytic engine: the dipole at |x - y| with coefficients averaged along the
// straight path from x to y (path_stencil.h). Slices are computed on demand, from any thread, and
// agree with eval_dipole to a relative error of 2e-6; values below the smallest normal float
// become that one, so that all are positive.
std::unique_ptr<SliceSource> make_analytic_source(const Sample& sample);

}  // namespace parian
