#include "app/cli/output.h"

#include <cstdio>

#include "base/error.h"
#include "io/json/json.h"

namespace parian {
namespace {

void write_out(const std::string& text) {
  std::fwrite(text.data(), 1, text.size(), stdout);
  if (std::fflush(stdout) != 0 || std::ferror(stdout))
    throw Error({"standard output", {}, "to be written", "an error"}, ErrorKind::resource);
}

}  // namespace

void print_summary(const Context& context, const std::string& text) {
  if (!context.quiet && context.json != "-") write_out(text);
}

void write_figures(const Context& context, const Document& figures) {
  if (context.json == "-") {
    write_out(format_document(figures) + "\n");
  } else if (!context.json.empty()) {
    save_document(context.json, figures);
  }
}

Document read_provenance(const std::string& text) {
  if (text.empty()) return nullptr;
  try {
    return parse_document(text, "provenance");
  } catch (const Error&) {
    return text;
  }
}

}  // namespace parian
