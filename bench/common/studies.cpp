#include "bench/common/studies.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <filesystem>

namespace parian {
namespace {

int show_usage(const std::string& program, const Page& page,
               const std::vector<NamedStudy>& studies) {
  std::string text = fmt::format("usage: {} [all|STUDY...] [-o FOLDER] [--docs DOCS]\n\n", program);
  text += "studies:";
  for (const NamedStudy& study : studies)
    text += ' ' + study.name + (study.in_all ? "" : " (not in all)");
  text += fmt::format(
      "\n\nMarkdown tables go to the standard output and to FOLDER/*.md, pictures to FOLDER\n"
      "(default: {}). --docs docs brings the page and its pictures up to date.\n",
      page.folder);
  std::fputs(text.c_str(), stderr);
  return 2;
}

}  // namespace

int run_studies(int argc, char** argv, const std::string& page_name,
                const std::vector<NamedStudy>& studies) {
  const std::string program = std::filesystem::path(argv[0]).filename().string();
  Page page{.name = page_name,
            .folder = PARIAN_SOURCE_DIR "/out/bench/" + program.substr(program.find('_') + 1),
            .docs = {}};
  std::vector<std::string> chosen;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "-o" && i + 1 < argc)
      page.folder = argv[++i];
    else if (word == "--docs" && i + 1 < argc)
      page.docs = argv[++i];
    else
      chosen.push_back(word);
  }
  const auto is_chosen = [&](const std::string& name) {
    return std::find(chosen.begin(), chosen.end(), name) != chosen.end();
  };
  const bool all = chosen.empty() || is_chosen("all");
  for (const std::string& word : chosen) {
    const auto has_name = [&](const NamedStudy& study) { return study.name == word; };
    if (word != "all" && std::none_of(studies.begin(), studies.end(), has_name))
      return show_usage(program, page, studies);
  }
  try {
    for (const NamedStudy& study : studies)
      if ((all && study.in_all) || is_chosen(study.name)) study.run(page);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}: {}\n", program, error.what());
    return 1;
  }
  return 0;
}

}  // namespace parian
