// Homogeneous materials edited live: every figure of docs/homogeneous.md.
//   bench_homogeneous [models|basis|accuracy|speed|pictures] [--large] [--docs docs]
#include <cstdio>
#include <string>

#include "base/error.h"
#include "base/memory.h"
#include "bench/homogeneous/study.h"

int main(int argc, char** argv) {
  parian::keep_freed_memory();
  std::string docs, section;
  bool with_largest = false;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--docs" && i + 1 < argc)
      docs = argv[++i];
    else if (word == "--large")
      with_largest = true;
    else
      section = word;
  }
  const parian::Page page{.name = "homogeneous", .folder = "out/bench", .docs = docs};
  const auto is_wanted = [&](const char* name) { return section.empty() || section == name; };
  try {
    if (is_wanted("models")) study_models(page);
    if (is_wanted("basis")) study_bases(page);
    if (is_wanted("accuracy")) study_accuracy(page);
    if (is_wanted("speed")) study_speed(page, with_largest);
    if (is_wanted("pictures")) study_pictures(page);
  } catch (const parian::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
  return 0;
}
