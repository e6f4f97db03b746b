// bench_compress [all|race|tables|rates|pictures|large|noise] [-o FOLDER] [--docs DOCS]: prints the
// tables of docs/compression.md and draws its pictures.
#include <cstdio>
#include <exception>
#include <string>

#include "base/memory.h"
#include "bench/compression/study.h"

namespace parian::compression {
namespace {

struct NamedStudy {
  const char* name;
  void (*run)(const Page&);
};
constexpr NamedStudy studies[] = {{"race", study_race},   {"tables", study_tables},
                                  {"rates", study_rates}, {"pictures", study_pictures},
                                  {"large", study_large}, {"noise", study_noise}};

int show_usage() {
  std::fputs(
      "usage: bench_compress [all|race|tables|rates|pictures|large|noise] [-o FOLDER]\n"
      "                      [--docs DOCS]\n"
      "\n"
      "Compression beside the 2019 paper's optimiser and other methods: Markdown tables to the\n"
      "standard output and to FOLDER/*.md, pictures to FOLDER (default: out/bench/compression).\n"
      "--docs docs brings docs/compression.md and docs/images/compression-*.png up to date.\n",
      stderr);
  return 2;
}

int run(int argc, char** argv) {
  std::string chosen;
  Page page{"compression", "", ""};
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument == "-o" && i + 1 < argc && page.folder.empty())
      page.folder = argv[++i];
    else if (argument == "--docs" && i + 1 < argc && page.docs.empty())
      page.docs = argv[++i];
    else if (chosen.empty() && argument[0] != '-')
      chosen = argument;
    else
      return show_usage();
  }
  if (chosen.empty()) chosen = "all";
  if (page.folder.empty()) page.folder = PARIAN_SOURCE_DIR "/out/bench/compression";
  bool known = chosen == "all";
  for (const NamedStudy& each : studies) known = known || chosen == each.name;
  if (!known) return show_usage();
  for (const NamedStudy& each : studies)
    if (chosen == "all" || chosen == each.name) each.run(page);
  return 0;
}

}  // namespace
}  // namespace parian::compression

int main(int argc, char** argv) {
  parian::keep_freed_memory();
  try {
    return parian::compression::run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bench_compress: %s\n", error.what());
    return 1;
  }
}
