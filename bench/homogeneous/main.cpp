// Homogeneous materials edited live, for docs/homogeneous.md.
#include "base/memory.h"
#include "bench/common/studies.h"
#include "bench/homogeneous/study.h"

int main(int argc, char** argv) {
  using namespace parian;
  keep_freed_memory();
  return run_studies(argc, argv, "homogeneous",
                     {{"models", study_models},
                      {"basis", study_bases},
                      {"accuracy", study_accuracy},
                      {"speed", [](const Page& page) { study_speed(page, false); }},
                      {"speed-large", [](const Page& page) { study_speed(page, true); }, false},
                      {"pictures", study_pictures}});
}
