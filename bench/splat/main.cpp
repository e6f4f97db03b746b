// Splatting: every figure and picture of docs/splatting.md.
//   bench_splat [speed] [samples] [edit] [live] [accuracy] [pictures] [--docs docs]
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "base/error.h"
#include "bench/splat/study.h"

int main(int argc, char** argv) {
  std::vector<std::string> chosen;
  parian::Page page{.name = "splatting", .folder = "out/bench", .docs = {}};
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--docs" && i + 1 < argc)
      page.docs = argv[++i];
    else
      chosen.push_back(word);
  }
  const auto is_chosen = [&](const char* name) {
    return chosen.empty() || std::find(chosen.begin(), chosen.end(), name) != chosen.end();
  };
  try {
    std::filesystem::create_directories(page.folder);
    const parian::OffscreenContext context;
    fmt::print("{}, {}\n", context.limits().renderer, context.limits().version);
    if (is_chosen("speed")) study_speed(page, context.limits());
    if (is_chosen("samples")) study_samples(page, context.limits());
    if (is_chosen("edit")) study_edits(page, context.limits());
    if (is_chosen("live")) study_live(page, context.limits());
    if (is_chosen("accuracy")) study_accuracy(page, context.limits());
    if (is_chosen("pictures")) study_pictures(page, context.limits());
  } catch (const parian::Error& error) {
    fmt::print(stderr, "bench_splat: {}\n", error.what());
    return 1;
  }
  return 0;
}
