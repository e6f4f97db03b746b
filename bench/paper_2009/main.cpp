// bench_paper_2009 [all|table1|segments|line|points|contrast|noise] [-o FOLDER] [--docs DOCS]:
// prints the tables of docs/fit.md and draws its pictures.
#include <cstdio>
#include <exception>
#include <iterator>
#include <string>

#include "bench/paper_2009/study.h"

namespace parian::paper_2009 {
namespace {

struct NamedStudy {
  const char* name;
  void (*run)(Study&);
};
// Those that need the chessboard, the largest table, follow each other.
constexpr NamedStudy studies[] = {{"segments", study_segments}, {"contrast", study_contrast},
                                  {"noise", study_noise},       {"line", study_line},
                                  {"points", study_points},     {"table1", study_table1}};

int show_usage() {
  std::fputs(
      "usage: bench_paper_2009 [all|table1|segments|line|points|contrast|noise]\n"
      "                        [-o FOLDER] [--docs DOCS]\n"
      "\n"
      "The evaluation of the SubEdit paper on simulated samples: Markdown tables to the standard\n"
      "output and to FOLDER/*.md, pictures to FOLDER/fit-*.png (default: out/bench/paper_2009).\n"
      "--docs docs brings docs/fit.md and docs/images/fit-*.png up to date.\n",
      stderr);
  return 2;
}

int run(int argc, char** argv) {
  std::string chosen;
  Study study;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument == "-o" && i + 1 < argc && study.page.folder.empty())
      study.page.folder = argv[++i];
    else if (argument == "--docs" && i + 1 < argc && study.page.docs.empty())
      study.page.docs = argv[++i];
    else if (chosen.empty() && argument[0] != '-')
      chosen = argument;
    else
      return show_usage();
  }
  if (chosen.empty()) chosen = "all";
  if (study.page.folder.empty()) study.page.folder = PARIAN_SOURCE_DIR "/out/bench/paper_2009";
  bool known = chosen == "all";
  for (const NamedStudy& each : studies) known = known || chosen == each.name;
  if (!known) return show_usage();
  for (const NamedStudy& each : studies)
    if (chosen == "all" || chosen == each.name) each.run(study);
  return 0;
}

}  // namespace
}  // namespace parian::paper_2009

int main(int argc, char** argv) {
  try {
    return parian::paper_2009::run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bench_paper_2009: %s\n", error.what());
    return 1;
  }
}
