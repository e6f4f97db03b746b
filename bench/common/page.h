// Tables and pictures of a page of the docs, as a benchmark writes them.
#pragma once

#include <string>
#include <vector>

#include "image/image.h"

namespace parian {

struct Page {
  std::string name;    // "fit": docs/fit.md, pictures fit-*.png
  std::string folder;  // of the pictures and tables
  std::string docs;    // where the page is to be brought up to date; may be empty
};

struct MarkdownTable {
  std::vector<std::string> header;  // the first column is text, the others are numbers
  std::vector<std::vector<std::string>> rows;
};
// Prints `text` and the table, and writes both to FOLDER/<name>.md and between the page's
// <!-- name --> and <!-- /name -->.
void write_table(const Page& page, const std::string& name, const std::string& text,
                 const MarkdownTable& table);
// Writes <page>-<name>.png to FOLDER, or to the images of the docs.
void write_picture(const Page& page, const std::string& name, const Image& image);

}  // namespace parian
