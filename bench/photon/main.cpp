// bench_photon [all|STUDY] [-o FOLDER] [--docs DOCS]; studies are listed below.
#include <cstdio>
#include <exception>
#include <filesystem>
#include <string>

#include "bench/photon/study.h"

namespace parian::photon {
namespace {

struct NamedStudy {
  const char* name;
  void (*run)(Study&);
};
constexpr NamedStudy studies[] = {{"speed", study_speed},
                                  {"totals", study_totals},
                                  {"time", study_time},
                                  {"similarity", study_similarity},
                                  {"importance", study_importance},
                                  {"dipole", study_dipole},
                                  {"pictures", study_pictures},
                                  {"limits", study_limits},
                                  {"thickness", study_thickness},
                                  {"curvature", study_curvature}};

int show_usage() {
  std::fputs(
      "usage: bench_photon [all|speed|totals|time|similarity|importance|dipole|pictures|limits|\n"
      "                     thickness|curvature] [-o FOLDER] [--docs DOCS]\n"
      "\n"
      "The photon engine: Markdown tables to the standard output and to FOLDER/*.md, pictures to\n"
      "FOLDER (default: out/bench/photon). --docs docs brings docs/acquisition.md, docs/limits.md\n"
      "and their pictures up to date.\n",
      stderr);
  return 2;
}

int run(int argc, char** argv) {
  std::string chosen;
  Study study;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument == "-o" && i + 1 < argc && study.folder.empty())
      study.folder = argv[++i];
    else if (argument == "--docs" && i + 1 < argc && study.docs.empty())
      study.docs = argv[++i];
    else if (chosen.empty() && argument[0] != '-')
      chosen = argument;
    else
      return show_usage();
  }
  if (chosen.empty()) chosen = "all";
  if (study.folder.empty()) study.folder = PARIAN_SOURCE_DIR "/out/bench/photon";
  bool known = chosen == "all";
  for (const NamedStudy& each : studies) known = known || chosen == each.name;
  if (!known) return show_usage();
  std::filesystem::create_directories(study.folder);
  if (!study.docs.empty()) std::filesystem::create_directories(study.docs + "/images");
  for (const NamedStudy& each : studies)
    if (chosen == "all" || chosen == each.name) each.run(study);
  return 0;
}

}  // namespace
}  // namespace parian::photon

int main(int argc, char** argv) {
  try {
    return parian::photon::run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bench_photon: %s\n", error.what());
    return 1;
  }
}
