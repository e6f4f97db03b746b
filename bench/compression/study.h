// Compression to K base materials per pixel beside the 2019 paper's optimiser and other methods:
// what the studies share.
#pragma once

#include <string>
#include <vector>

#include "bench/common/page.h"
#include "compress/compress.h"
#include "fit/fit.h"
#include "judge/compare.h"
#include "material/bssrdf_table.h"
#include "material/material.h"

namespace parian::compression {

// A sample's table in memory, and its fit.
struct Sample {
  std::string name;
  BssrdfTable table;
  ProfileMap map;
  double fit_seconds = 0;
};
Sample load_sample(const std::string& name);

struct Compressed {
  ProfileBlend blend;
  CompressReport report;
  CompareReport errors;
  double seconds = 0;     // with the fit and the pass over the table for what the fit misses
  std::size_t bytes = 0;  // paper encoding without header
};
Compressed compress_sample(const Sample& sample, const CompressParams& params);
CompressParams make_params(int bases, int per_pixel, Objective objective = Objective::balanced);

CompareReport judge(const Sample& sample, const Material& material);

std::string format_kb(std::size_t bytes);

void study_race(const Page& page);
void study_tables(const Page& page);
void study_rates(const Page& page);
void study_pictures(const Page& page);
void study_large(const Page& page);
void study_noise(const Page& page);

}  // namespace parian::compression
