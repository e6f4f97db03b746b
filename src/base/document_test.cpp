#include "base/document.h"

#include <gtest/gtest.h>

#include "base/test_errors.h"

namespace parian {
namespace {

Document located(Document node, const std::string& pointer) {
  node.file = std::make_shared<std::string>("a.json");
  node.pointer = pointer;
  return node;
}

TEST(Document, TypedAccessNamesTheplace) {
  const Document node = located("wax", "/layout/kind");
  EXPECT_EQ(as_string(node), "wax");
  EXPECT_EQ(error_of([&] { as_number(node); }),
            "a.json: /layout/kind: expected a number, found the string 'wax'");
  EXPECT_EQ(error_of([&] { as_int(located(2.5, "/n"), 1, 9); }),
            "a.json: /n: expected a whole number in [1, 9], found the number 2.5");
}

TEST(Document, UnknownKeysNameTheNearest) {
  Document object = located(Document::Object{}, "");
  set(object, "radis_mm", located(1.0, "/radis_mm"));
  EXPECT_EQ(
      error_of([&] {
        check_keys(object, {"pitch_mm", "radius_mm"});
      }),
      "a.json: /radis_mm: expected a known key, found 'radis_mm' (did you mean 'radius_mm'?)");
  EXPECT_EQ(error_of([&] { get(object, "pitch_mm"); }),
            "a.json: /: expected the key 'pitch_mm', found no such key");
}

TEST(Document, ParamsRoundTripAndAreChecked) {
  int segments = 24;
  double lambda = 0.5;
  std::vector<double> knots{0, 1, 3};
  const ParamList params{{.name = "segments", .help = "", .target = &segments, .min = 1, .max = 99},
                         {.name = "lambda", .help = "", .target = &lambda, .min = 0},
                         {.name = "knots-mm", .help = "", .target = &knots}};
  const Document saved = write_params(params);
  segments = 1, lambda = 0, knots.clear();
  read_params(saved, params);
  EXPECT_EQ(segments, 24);
  EXPECT_EQ(lambda, 0.5);
  EXPECT_EQ(knots, (std::vector<double>{0, 1, 3}));

  Document bad = located(Document::Object{}, "");
  set(bad, "segments", located(1000, "/segments"));
  EXPECT_EQ(error_of([&] { read_params(bad, params); }),
            "a.json: /segments: expected a value in [1, 99], found 1000");
  Document text = located(Document::Object{}, "");
  set(text, "knots_mm", located("x", "/knots_mm"));
  EXPECT_EQ(error_of([&] { read_params(text, params); }),
            "a.json: /knots_mm: expected a number or an array of numbers, found the string 'x'");
}

}  // namespace
}  // namespace parian
