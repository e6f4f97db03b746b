// Several files at once, as they are dropped on the window or named on the command line.
#include <algorithm>
#include <cctype>
#include <filesystem>

#include "app/cli/inputs.h"
#include "app/studio/studio_files.h"

namespace parian {
namespace {

bool is_material(FileKind kind) {
  return kind == FileKind::table || kind == FileKind::map || kind == FileKind::blend;
}

// Recipes and photographs need the map that may come with them.
bool needs_map(const std::string& path, FileKind kind) {
  if (kind == FileKind::json) return true;
  return kind == FileKind::image && !is_environment_image(path);
}

// What is wrong with it is said when it is opened.
FileKind kind_of(const std::string& path) {
  try {
    return find_file_kind(path);
  } catch (const std::exception&) {
    return FileKind::other;
  }
}

bool is_opening(const Studio& studio) {
  const std::vector<JobView> jobs = studio.jobs.views();
  return std::any_of(jobs.begin(), jobs.end(),
                     [](const JobView& job) { return job.name.starts_with("open "); });
}

}  // namespace

bool is_environment_image(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension == ".exr" || extension == ".hdr";
}

void open_files(Studio& studio, const std::vector<std::string>& paths) {
  int materials = 0, meshes = 0;
  for (const std::string& path : paths) {
    const FileKind kind = kind_of(path);
    if (is_material(kind) && ++materials > 2) {
      report(studio,
             path +
                 ": not opened: of several materials the first is edited, and the second is "
                 "there to pick from",
             true);
      continue;
    }
    const bool is_second = is_material(kind) && materials == 2;
    const bool is_next_mesh = kind == FileKind::mesh && ++meshes > 1;
    if (is_second || is_next_mesh || needs_map(path, kind))
      studio.waiting_files.push_back({path, is_second});
    else
      open_file(studio, path);
  }
  open_waiting(studio);
}

void open_waiting(Studio& studio) {
  while (!studio.waiting_files.empty() && !is_opening(studio)) {
    const WaitingFile next = studio.waiting_files.front();
    studio.waiting_files.pop_front();
    if (next.is_second)
      open_second(studio, next.path);
    else
      open_file(studio, next.path);
  }
}

}  // namespace parian
