#include "bench/common/page.h"

#include <cstdio>
#include <filesystem>

#include "base/error.h"
#include "io/image/image_file.h"
#include "io/json/files.h"

namespace parian {
namespace {

std::string format_row(const std::vector<std::string>& cells) {
  std::string row = "|";
  for (const std::string& cell : cells) row += ' ' + cell + " |";
  return row + '\n';
}

void replace_in_page(const std::string& path, const std::string& name, const std::string& text) {
  std::string contents = read_file(path, std::size_t{1} << 24u);
  const std::string open = "<!-- " + name + " -->\n", close = "<!-- /" + name + " -->";
  const std::size_t begin = contents.find(open), end = contents.find(close);
  if (begin == std::string::npos || end == std::string::npos || end < begin)
    throw Error({path, {}, open + close, "none"});
  contents.replace(begin + open.size(), end - begin - open.size(), text);
  write_text(path, contents);
}

}  // namespace

void write_table(const Page& page, const std::string& name, const std::string& text,
                 const MarkdownTable& table) {
  std::string markdown = text + "\n\n" + format_row(table.header) + "|---|";
  for (std::size_t i = 1; i < table.header.size(); ++i) markdown += "---:|";
  markdown += '\n';
  for (const auto& row : table.rows) markdown += format_row(row);
  std::printf("%s\n", markdown.c_str());
  std::fflush(stdout);
  std::filesystem::create_directories(page.folder);
  write_text(page.folder + '/' + name + ".md", markdown);
  if (!page.docs.empty()) replace_in_page(page.docs + "/" + page.name + ".md", name, markdown);
}

void write_picture(const Page& page, const std::string& name, const Image& image) {
  const std::string folder = page.docs.empty() ? page.folder : page.docs + "/images";
  std::filesystem::create_directories(folder);
  const std::string path = folder + "/" + page.name + "-" + name + ".png";
  save_image(path, image);
  std::fprintf(stderr, "%s\n", path.c_str());
}

}  // namespace parian
