#include "bench/paper_2009/study.h"

#include <fmt/format.h>

#include <chrono>
#include <cstdio>

#include "acquire/sample.h"
#include "base/error.h"
#include "io/image/image_file.h"
#include "io/json/files.h"
#include "io/json/json.h"
#include "material/material.h"

namespace parian::paper_2009 {

Document load_sample(const std::string& name) {
  return load_document(std::string(PARIAN_SOURCE_DIR) + "/data/samples/" + name + ".json");
}

BssrdfTable simulate(const Document& description) {
  const ImageLoader no_images = [](const std::string& path) -> Image {
    throw Error({path, {}, "a sample without images", {}});
  };
  return read_table(*make_analytic_source(read_sample(description, no_images)));
}

const BssrdfTable& get_sample(Study& study, const std::string& name) {
  if (study.sample == name) return study.table;
  study.table = {};
  study.sample.clear();
  std::fprintf(stderr, "simulating %s\n", name.c_str());
  study.table = simulate(load_sample(name));
  study.sample = name;
  return study.table;
}

FitParams paper_params() {
  FitParams params;
  params.segments = 24;
  params.lambda = 0.01;
  params.weight = PairWeight::uniform;
  params.monotone = false;
  return params;
}

Judged fit_and_judge(const BssrdfTable& table, const FitParams& params) {
  const auto source = make_slices(table);
  const auto start = std::chrono::steady_clock::now();
  Judged judged{fit_profiles(*source, params), {}};
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  judged.seconds = seconds.count();
  const Material material = judged.fit.map;
  judged.errors = compare(*source, *make_slices(material, table.header), judged.fit.map.hold_out);
  std::size_t touched = 0;
  for (const FitChannelReport& channel : judged.fit.report.channels)
    touched += channel.profiles_touched;
  judged.touched = static_cast<double>(touched) /
                   static_cast<double>(table.header.pixels() * judged.fit.report.channels.size());
  return judged;
}

namespace {

std::string format_row(const std::vector<std::string>& cells) {
  std::string row = "|";
  for (const std::string& cell : cells) row += ' ' + cell + " |";
  return row + '\n';
}

void replace_in_page(const std::string& path, const std::string& name, const std::string& text) {
  std::string page = read_file(path, std::size_t{1} << 24u);
  const std::string open = "<!-- " + name + " -->\n", close = "<!-- /" + name + " -->";
  const std::size_t begin = page.find(open), end = page.find(close);
  if (begin == std::string::npos || end == std::string::npos || end < begin)
    throw Error({path, {}, open + close, "none"});
  page.replace(begin + open.size(), end - begin - open.size(), text);
  write_text(path, page);
}

}  // namespace

void write_table(const Study& study, const std::string& name, const std::string& text,
                 const MarkdownTable& table) {
  std::string markdown = text + "\n\n" + format_row(table.header) + "|---|";
  for (std::size_t i = 1; i < table.header.size(); ++i) markdown += "---:|";
  markdown += '\n';
  for (const auto& row : table.rows) markdown += format_row(row);
  std::printf("%s\n", markdown.c_str());
  std::fflush(stdout);
  write_text(study.folder + '/' + name + ".md", markdown);
  if (!study.docs.empty()) replace_in_page(study.docs + "/fit.md", name, markdown);
}

void write_picture(const Study& study, const std::string& name, const Image& image) {
  const std::string folder = study.docs.empty() ? study.folder : study.docs + "/images";
  const std::string path = folder + "/fit-" + name + ".png";
  save_image(path, image);
  std::fprintf(stderr, "%s\n", path.c_str());
}

}  // namespace parian::paper_2009
