// Compression beside the 2019 paper's optimiser and other methods, for docs/compression.md.
#include "base/memory.h"
#include "bench/common/studies.h"
#include "bench/compression/study.h"

int main(int argc, char** argv) {
  using namespace parian;
  using namespace parian::compression;
  keep_freed_memory();
  return run_studies(argc, argv, "compression",
                     {{"race", study_race},
                      {"tables", study_tables},
                      {"rates", study_rates},
                      {"pictures", study_pictures},
                      {"large", study_large},
                      {"noise", study_noise}});
}
