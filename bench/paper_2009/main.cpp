// The evaluation of the SubEdit paper on simulated samples, for docs/fit.md.
#include "bench/common/studies.h"
#include "bench/paper_2009/study.h"

int main(int argc, char** argv) {
  using namespace parian;
  using namespace parian::paper_2009;
  Study study;
  const auto with_study = [&study](void (*run)(Study&)) {
    return [&study, run](const Page& page) {
      study.page = page;
      run(study);
    };
  };
  // Those that need the chessboard, the largest table, follow each other.
  return run_studies(argc, argv, "fit",
                     {{"segments", with_study(study_segments)},
                      {"contrast", with_study(study_contrast)},
                      {"noise", with_study(study_noise)},
                      {"line", with_study(study_line)},
                      {"points", with_study(study_points)},
                      {"table1", with_study(study_table1)}});
}
