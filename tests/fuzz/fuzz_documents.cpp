// Mutated JSON text, parameters and sample descriptions.
#include <algorithm>
#include <filesystem>
#include <stdexcept>

#include "acquire/sample.h"
#include "fuzz_case.h"
#include "io/json/json.h"

namespace parian::fuzz {
namespace {

namespace fs = std::filesystem;

std::string mutate_bytes(Case& c, std::string text) {
  static const std::vector<std::string> tokens{"{",
                                               "}",
                                               "[",
                                               "]",
                                               ",",
                                               ":",
                                               "\"",
                                               "\\u12",
                                               "\\ud800",
                                               "null",
                                               "true",
                                               "1e999",
                                               "-",
                                               "0.0",
                                               "1e-400",
                                               "-0",
                                               "1e308",
                                               "\xff",
                                               "\"a\":",
                                               "//",
                                               "\"eta\":0",
                                               "[[[[[[[[",
                                               "99999999999999999999",
                                               "\"\":{}",
                                               "\"/~\":"};
  for (std::size_t edits = 1 + c.below(4); edits > 0; --edits) {
    const std::size_t at = c.below(text.size() + 1);
    switch (c.below(5)) {
      case 0:
        if (at < text.size()) text[at] = static_cast<char>(sample_u32(c.rng));
        break;
      case 1:
        text.erase(at, 1 + c.below(8));
        break;
      case 2:
        text.insert(at, c.pick(tokens));
        break;
      case 3:
        text.insert(at, text.substr(c.below(text.size() + 1), c.below(40)));
        break;
      default:
        if (c.one_in(4)) text.resize(at);
    }
  }
  return text;
}

Document odd_value(Case& c) {
  switch (c.below(7)) {
    case 0:
      return nullptr;
    case 1:
      return c.one_in(2);
    case 2:
      return c.pick<std::string>({"", "x", "chessboard", "../../etc", std::string(300, 'y')});
    case 3:
      return Document::Array{};
    case 4:
      return Document::Object{};
    case 5:
      return Document::Array{odd_number(c), odd_number(c), odd_number(c)};
    default:
      return odd_number(c);
  }
}

std::size_t count_nodes(const Document& node) {
  std::size_t count = 1;
  if (const auto* array = std::get_if<Document::Array>(&node.value))
    for (const Document& child : *array) count += count_nodes(child);
  if (const auto* object = std::get_if<Document::Object>(&node.value))
    for (const auto& [key, child] : *object) count += count_nodes(child);
  return count;
}

void mutate_node(Case& c, Document& node) {
  c.note("changed " + (node.pointer.empty() ? "/" : node.pointer));
  if (auto* object = std::get_if<Document::Object>(&node.value); object && !c.one_in(4)) {
    const std::size_t at = object->empty() ? 0 : c.below(object->size());
    if (object->empty() || c.one_in(3)) {
      object->emplace_back(c.pick<std::string>({"", "seed", "eta", "unknown"}), odd_value(c));
    } else if (c.one_in(2)) {
      object->erase(object->begin() + static_cast<std::ptrdiff_t>(at));
    } else {
      (*object)[at].first += "x";
    }
    return;
  }
  if (auto* array = std::get_if<Document::Array>(&node.value); array && !c.one_in(4)) {
    if (array->empty() || c.one_in(2)) {
      array->push_back(array->empty() || c.one_in(2) ? odd_value(c) : c.pick(*array));
    } else {
      array->erase(array->begin() + static_cast<std::ptrdiff_t>(c.below(array->size())));
    }
    return;
  }
  node.value = odd_value(c).value;
}

// Counts `index` down through the tree in document order and changes the node where it ends.
bool mutate_at(Case& c, Document& node, std::size_t& index) {
  if (index-- == 0) {
    mutate_node(c, node);
    return true;
  }
  if (auto* array = std::get_if<Document::Array>(&node.value))
    for (Document& child : *array)
      if (mutate_at(c, child, index)) return true;
  if (auto* object = std::get_if<Document::Object>(&node.value))
    for (auto& [key, child] : *object)
      if (mutate_at(c, child, index)) return true;
  return false;
}

// The bundled sample descriptions; none until there are some.
std::vector<Document> load_samples() {
  std::vector<Document> samples;
  const fs::path folder = PARIAN_SOURCE_DIR "/data/samples";
  if (!fs::is_directory(folder)) return samples;
  std::vector<std::string> paths;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.path().extension() == ".json") paths.push_back(entry.path().string());
  std::sort(paths.begin(), paths.end());
  for (const std::string& path : paths) samples.push_back(load_document(path));
  return samples;
}

}  // namespace

void mutate_document(Case& c, Document& document) {
  std::size_t index = c.below(count_nodes(document));
  mutate_at(c, document, index);
}

void fuzz_json(Case& c) {
  static const std::string text =
      R"({"name": "wax", "list": [1, 2.5e-3, -7], "nested": {"a": {"b": [[], {}]}}, "t": "\u00e4"})";
  const std::string changed = mutate_bytes(c, text);
  c.note(changed);
  const Document document = parse_document(changed, "fuzz.json");
  // What is read is written and read again to the same text.
  const std::string written = format_document(document);
  if (format_document(parse_document(written, "again")) != written)
    throw std::logic_error("a document changes when it is written and read: " + written);
}

void fuzz_params(Case& c) {
  bool flag = false;
  int segments = 0;
  std::uint64_t seed = 0;
  double radius = 0;
  std::string name;
  std::vector<double> knots;
  enum class Mode { fast, good } mode = Mode::fast;
  const ParamList params{
      {.name = "flag", .help = "", .target = &flag},
      {.name = "segments", .help = "", .target = &segments, .min = 0, .max = 256},
      {.name = "seed", .help = "", .target = &seed},
      {.name = "radius", .help = "", .target = &radius, .min = 0, .above_min = true},
      {.name = "name", .help = "", .target = &name},
      {.name = "knots", .help = "", .target = &knots, .min = 0},
      {.name = "mode", .help = "", .target = make_choice(mode, {"fast", "good"})}};
  Document document = parse_document(
      R"({"flag": true, "segments": 3, "seed": 7, "radius": 2, "name": "x", "knots": [0, 1], "mode": "good"})",
      "fuzz.json");
  mutate_document(c, document);
  read_params(document, params);
  if (segments < 0 || segments > 256 || !(radius >= 0))
    throw std::logic_error("a parameter out of range was accepted");
}

void fuzz_sample(Case& c) {
  static const std::vector<Document> samples = load_samples();
  if (samples.empty()) return;
  Document document = c.pick(samples);
  for (std::size_t edits = 1 + c.below(2); edits > 0; --edits) mutate_document(c, document);
  const ImageLoader load = [](const std::string&) { return make_image(3, 2, 3, 0.5f); };
  read_sample(document, load, c.one_in(2) ? -1 : 5);
}

}  // namespace parian::fuzz
