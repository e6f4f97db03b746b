// The evaluation of the SubEdit paper (Song et al. 2009, section 7) on Parian's simulated samples:
// what its studies share.
#pragma once

#include <string>
#include <vector>

#include "bench/common/page.h"
#include "fit/fit.h"
#include "image/image.h"
#include "judge/compare.h"
#include "material/bssrdf_table.h"

namespace parian::paper_2009 {

struct Study {
  Page page{"fit", "", ""};
  // The sample that was asked for last: the large ones are too large to keep, or to make twice.
  std::string sample;
  BssrdfTable table;
};

// The table of data/samples/<name>.json, simulated by the analytic engine into memory; valid until
// the next call.
const BssrdfTable& get_sample(Study& study, const std::string& name);
// The analytic engine's table of a description made by code.
BssrdfTable simulate(const Document& description);
// The description of data/samples/<name>.json.
Document load_sample(const std::string& name);

// Section 4.3 as printed: n = 24, lambda = 0.01, all pairs alike, no projection.
FitParams paper_params();

struct Judged {
  FitResult fit;
  CompareReport errors;
  double seconds = 0;  // of the fit
  double touched = 0;  // part of the profiles that the monotone projection changed
};
Judged fit_and_judge(const BssrdfTable& table, const FitParams& params);

inline void write_table(const Study& study, const std::string& name, const std::string& text,
                        const MarkdownTable& table) {
  parian::write_table(study.page, name, text, table);
}
inline void write_picture(const Study& study, const std::string& name, const Image& image) {
  parian::write_picture(study.page, name, image);
}

void study_table1(Study& study);
void study_segments(Study& study);
void study_line(Study& study);
void study_points(Study& study);
void study_contrast(Study& study);
void study_noise(Study& study);

}  // namespace parian::paper_2009
