// One sample taken all the way: table, fit, comparison, relit flats, plots; and the page's section
// about it.
#pragma once

#include <string>
#include <vector>

#include "base/progress.h"
#include "compress/compress.h"
#include "fit/fit.h"
#include "judge/compare.h"
#include "judge/plot.h"

namespace parian {

struct PipelineSample {
  std::string name;     // of its files: NAME-map.h5, ...
  std::string title;    // of its section
  std::string caption;  // where it comes from; says so if it is simulated
  std::string source;   // description that the table was simulated from, may be empty
  std::string table;    // path of the table
  std::string folder;   // where results go
};

struct PipelineResult {
  FitReport fit;
  CompareReport errors;  // of the map
  CompressReport compress;
  CompareReport blend_errors;
  std::size_t knots = 0;
  std::vector<PlotPixel> plotted;
  std::vector<float> light_gains;  // what uniform, disc and line pictures were multiplied by
};

// Writes NAME-map.h5, -blend.kbm, -fit.json, -errors.json, -errors.png,
// -LIGHT-{table,fit,blend,difference}.png and -profile-{1,2,3}.png into the folder.
PipelineResult run_pipeline(const PipelineSample& sample, const Progress& progress);

// HTML of those files.
std::string describe_pipeline(const PipelineSample& sample, const PipelineResult& result);

// Rows of the table of figures, one column per sample.
std::vector<std::vector<std::string>> tabulate(const std::vector<PipelineSample>& samples,
                                               const std::vector<PipelineResult>& results);

}  // namespace parian
