#include "app/cli/inputs.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <filesystem>

#include "base/error.h"
#include "io/hdf5/map_file.h"
#include "io/hdf5/table_file.h"
#include "io/json/files.h"

namespace parian {

FileKind find_file_kind(const std::string& path) {
  const std::string format = read_format(path);
  if (format == "parian-bssrdf-table") return FileKind::table;
  if (format == "parian-profile-map") return FileKind::map;
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (extension == ".json") return FileKind::sample;
  for (const char* known : {".png", ".jpg", ".jpeg", ".exr", ".hdr"})
    if (extension == known) return FileKind::image;
  return FileKind::other;
}

Surface open_surface(const std::string& path, const TableHeader* like) {
  Surface surface;
  if (find_file_kind(path) == FileKind::map) {
    surface.material = std::make_shared<const Material>(load_profile_map(path));
    surface.slices =
        make_slices(*surface.material, like ? *like : natural_header(*surface.material), path);
  } else {  // whatever it is, its error is that of a table
    surface.slices = open_table(path);
  }
  return surface;
}

void check_output(const std::string& path, const std::vector<std::string>& inputs) {
  std::error_code ignored;
  for (const std::string& input : inputs)
    if (std::filesystem::equivalent(path, input, ignored))
      throw Error({path, {}, "an output of another name", "the input"}, ErrorKind::usage);
  check_writable(path);
}

PlotPixel parse_pixel(const std::string& text, const TableHeader& header) {
  PlotPixel pixel;
  const char* end = text.data() + text.size();
  const auto first = std::from_chars(text.data(), end, pixel.x);
  const bool has_comma = first.ec == std::errc() && first.ptr != end && *first.ptr == ',';
  const auto second = has_comma ? std::from_chars(first.ptr + 1, end, pixel.y) : first;
  const bool is_inside =
      pixel.x >= 0 && pixel.x < header.width && pixel.y >= 0 && pixel.y < header.height;
  if (!has_comma || second.ec != std::errc() || second.ptr != end || !is_inside)
    throw Error({{},
                 "--plot",
                 fmt::format("a pixel X,Y in a grid of {} x {}", header.width, header.height),
                 "'" + text + "'"},
                ErrorKind::usage);
  return pixel;
}

}  // namespace parian
