// The shipped sample descriptions, and their schema against the readers.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "acquire/sample.h"
#include "base/test_errors.h"
#include "io/json/json.h"

namespace parian {
namespace {

using testing::HasSubstr;
using testing::Not;

const std::string data_folder = std::string(PARIAN_SOURCE_DIR) + "/data/";

std::vector<std::string> shipped_samples() {
  std::vector<std::string> paths;
  for (const auto& entry : std::filesystem::directory_iterator(data_folder + "samples"))
    if (entry.path().extension() == ".json") paths.push_back(entry.path().string());
  std::sort(paths.begin(), paths.end());
  return paths;
}

Document pair_of(int a, int b) {
  return Document::Array{a, b};
}

// On a smaller grid of the same pitch, so that it takes no time.
TEST(Samples, EveryShippedDescriptionReads) {
  EXPECT_GE(shipped_samples().size(), 7u);
  for (const std::string& path : shipped_samples()) {
    Document document = load_document(path);
    set(document, "size", pair_of(40, 32));
    const Sample sample = read_sample(document, {});
    EXPECT_EQ(sample.name, std::filesystem::path(path).stem().string());
    EXPECT_NE(as_string(get(document, "description")).find("Simulated"), std::string::npos) << path;
    // They are heterogeneous, and light reaches the window's edge without filling it.
    const auto [low, high] = std::minmax_element(sample.sigma_a.begin(), sample.sigma_a.end());
    EXPECT_GT(*high, 2 * *low) << path;
    const auto source = make_analytic_source(sample);
    std::vector<float> centre(sample.pixels()), edge(sample.pixels());
    const int reach = static_cast<int>(sample.radius_px);
    source->read_slice(0, find_offset(source->header(), {0, 0}), centre.data());
    source->read_slice(0, find_offset(source->header(), {reach, 0}), edge.data());
    EXPECT_LT(edge[0], 0.1f * centre[0]) << path;
    EXPECT_GT(edge[0], 1e-6f * centre[0]) << path;
  }
}

TEST(Samples, SixHaveThePapersSizes) {
  const std::map<std::string, std::pair<int, int>> sizes{
      {"chessboard", {222, 222}}, {"blue-wax", {88, 232}},    {"artificial-stone", {108, 108}},
      {"jade", {260, 260}},       {"yellow-wax", {110, 110}}, {"onyx", {229, 229}}};
  for (const auto& [name, size] : sizes) {
    const Document document = load_document(data_folder + "samples/" + name + ".json");
    EXPECT_EQ(
        as_numbers(get(document, "size")),
        (std::vector<double>{static_cast<double>(size.first), static_cast<double>(size.second)}))
        << name;
  }
}

// The published schema lists the same keys, defaults and ranges.
TEST(Samples, SchemaAgreesWithTheLayouts) {
  const Document schema = load_document(data_folder + "schema/sample.schema.json");
  const Document& definitions = get(schema, "$defs");
  for (const std::string& kind : layout_kinds()) {
    const Document& properties = get(get(definitions, kind), "properties");
    EXPECT_EQ(as_string(get(get(properties, "kind"), "const")), kind);
    Layout layout = make_layout(kind);
    const ParamList params = describe(layout);
    const std::size_t read_apart = kind == "image" ? 2 : 1;  // "kind", and a stack's "images"
    EXPECT_EQ(as_object(properties).size(), params.size() + read_apart) << kind;
    for (const Param& param : params) {
      const Document* property = &get(properties, json_key(param));
      if (const Document* value = find(*property, "default")) {
        EXPECT_EQ(std::stod(format_value(param)), as_number(*value)) << kind << ' ' << param.name;
      }
      if (const Document* reference = find(*property, "$ref"))
        property = &get(definitions, as_string(*reference).substr(std::string("#/$defs/").size()));
      if (const Document* minimum = find(*property, "minimum")) {
        EXPECT_EQ(as_number(*minimum), param.min) << kind << ' ' << param.name;
      }
      if (const Document* maximum = find(*property, "maximum")) {
        EXPECT_EQ(as_number(*maximum), param.max) << kind << ' ' << param.name;
      }
    }
  }
}

TEST(Samples, SchemaAgreesAboutDepth) {
  const Document schema = load_document(data_folder + "schema/sample.schema.json");
  const Document& properties = get(get(get(schema, "properties"), "depth"), "properties");
  SampleDepth depth;
  const ParamList params = describe(depth);
  EXPECT_EQ(as_object(properties).size(), params.size());
  for (const Param& param : params) {
    const Document& property = get(properties, json_key(param));
    if (param.name == "solid") continue;
    EXPECT_EQ(as_number(get(property, "default")), std::stod(format_value(param))) << param.name;
    EXPECT_EQ(as_number(get(property, "minimum")), param.min) << param.name;
    EXPECT_EQ(as_number(get(property, "maximum")), param.max) << param.name;
  }
}

// The published schema lists the same keys as the reader.
TEST(Samples, SchemaAgreesWithTheReader) {
  const Document schema = load_document(data_folder + "schema/sample.schema.json");
  std::vector<std::string> keys;
  for (const auto& [key, value] : as_object(get(schema, "properties"))) keys.push_back(key);
  Document document = load_document(data_folder + "samples/chessboard-small.json");
  for (const std::string& key : keys) {
    // A key of the schema is never unknown; one that is not in it always is.
    Document with = document;
    if (find(with, key) == nullptr) set(with, key, Document(nullptr));
    EXPECT_THAT(error_of([&] { read_sample(with, {}); }), Not(HasSubstr("known key"))) << key;
  }
  set(document, "colour", 1);
  EXPECT_THROW(read_sample(document, {}), Error);
}

}  // namespace
}  // namespace parian
