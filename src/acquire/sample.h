// Virtual samples: base materials, a layout that mixes them over the plane, and a grid. Simulated,
// not measured: every table made from one says so in its provenance.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "base/document.h"
#include "image/image.h"
#include "material/dipole.h"
#include "material/slices.h"

namespace parian {

// Loads an image that a description names, relative to the description's file.
using ImageLoader = std::function<Image(const std::string& path)>;

struct Sample;

// Reads and checks a description (docs/samples.md, data/schema/sample.schema.json). Errors name
// file and JSON pointer. `seed` replaces the description's when it is not negative.
Sample read_sample(const Document& document, const ImageLoader& load_image, std::int64_t seed = -1);

// The table of the analytic engine: the dipole at |x - y| with coefficients averaged along the
// straight path from x to y. Slices are computed on demand.
std::unique_ptr<SliceSource> make_analytic_source(const Sample& sample);

}  // namespace parian
