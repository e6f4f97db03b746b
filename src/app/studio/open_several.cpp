// Several files at once, as they are dropped on the window or named on the command line.
#include <algorithm>
#include <cctype>
#include <filesystem>

#include "app/studio/studio_files.h"

namespace parian {
namespace {

// Recipes and photographs need the map that may come with them.
bool needs_map(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension == ".json" || extension == ".png" || extension == ".jpg" || extension == ".jpeg";
}

bool is_opening(const Studio& studio) {
  const std::vector<JobView> jobs = studio.jobs.views();
  return std::any_of(jobs.begin(), jobs.end(),
                     [](const JobView& job) { return job.name.starts_with("open "); });
}

}  // namespace

void open_files(Studio& studio, const std::vector<std::string>& paths) {
  for (const std::string& path : paths)
    if (needs_map(path))
      studio.waiting_files.push_back(path);
    else
      open_file(studio, path);
  open_waiting(studio);
}

void open_waiting(Studio& studio) {
  while (!studio.waiting_files.empty() && !is_opening(studio)) {
    const std::string path = studio.waiting_files.front();
    studio.waiting_files.pop_front();
    open_file(studio, path);
  }
}

}  // namespace parian
