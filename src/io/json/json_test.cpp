#include "io/json/json.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "base/random.h"
#include "base/test_errors.h"

namespace parian {
namespace {

std::string error_of(const std::string& text) {
  return parian::error_of([&] { parse_document(text, "a.json"); });
}

TEST(Json, NodesKnowFileAndPointer) {
  const Document document =
      parse_document(R"({"a": [1, {"b/c~d": true}], "e": null})", "dir/a.json");
  const Document& deep = get(as_array(get(document, "a"))[1], "b/c~d");
  EXPECT_TRUE(as_bool(deep));
  EXPECT_EQ(deep.pointer, "/a/1/b~1c~0d");
  EXPECT_EQ(*deep.file, "dir/a.json");
  EXPECT_EQ(document.pointer, "");
  EXPECT_TRUE(std::holds_alternative<std::nullptr_t>(get(document, "e").value));
}

TEST(Json, SyntaxErrorsNameLineAndColumn) {
  EXPECT_EQ(error_of("{\n  \"a\": 1,\n  b\n}"),
            "a.json: line 3, column 3: expected string literal, found invalid literal");
  EXPECT_EQ(error_of("{\"a\": [1, 2}"), "a.json: line 1, column 12: expected ']', found '}'");
  EXPECT_EQ(error_of("[1, 2"), "a.json: line 1, column 6: expected ']', found end of input");
  EXPECT_EQ(error_of(""),
            "a.json: line 1, column 1: expected '[', '{', or a literal, found end of input");
  EXPECT_EQ(error_of("[1] 2"),
            "a.json: line 1, column 5: expected end of input, found number literal");
  EXPECT_EQ(error_of("[NaN]"),
            "a.json: line 1, column 2: expected valid JSON, found invalid literal");
  EXPECT_EQ(error_of("[1e999]"),
            "a.json: line 1, column 6: expected a number that fits a double, found 1e999");
}

TEST(Json, DuplicateKeysAndDepthAreErrors) {
  EXPECT_EQ(error_of(R"({"a": {"b": 1, "c": 2, "b": 3}})"),
            "a.json: /a/b: expected each key once, found it again");
  EXPECT_EQ(error_of(std::string(64, '[') + std::string(64, ']')), "no error");
  std::string place;
  for (int i = 0; i < 64; ++i) place += "/0";
  EXPECT_EQ(error_of(std::string(65, '[')),
            "a.json: " + place + ": expected nesting of at most 64 levels, found a deeper one");
}

// Long keys above many values would make pointers quadratic in the text.
TEST(Json, MemoryIsBounded) {
  std::string text = "{\"" + std::string(1 << 20, 'k') + "\": [0";
  for (int i = 0; i < 2000; ++i) text += ",0";
  text += "]}";
  EXPECT_NE(error_of(text).find("expected a document of at most 512 MiB in memory, found more"),
            std::string::npos);
}

TEST(Json, FormatIsIndentedAndShortest) {
  Document document;
  set(document, "whole", 3.0);
  set(document, "tenth", 0.1);
  set(document, "large", 1e300);
  set(document, "nan", std::numeric_limits<double>::quiet_NaN());
  set(document, "infinite", -std::numeric_limits<double>::infinity());
  set(document, "text", "a\"b\n\xff");
  set(document, "list", Document::Array{1, 2.5, "x"});
  set(document, "rows", Document::Array{Document::Array{}, Document::Array{1}});
  set(document, "none", Document::Object{});
  EXPECT_EQ(format_document(document), R"({
  "whole": 3,
  "tenth": 0.1,
  "large": 1e+300,
  "nan": null,
  "infinite": null,
  "text": "a\"b\n)"
                                       "\xef\xbf\xbd"
                                       R"(",
  "list": [1, 2.5, "x"],
  "rows": [
    [],
    [1]
  ],
  "none": {}
})");
}

TEST(Json, NumbersRoundTripBitForBit) {
  Rng rng = make_rng(3);
  for (int i = 0; i < 2000; ++i) {
    const double value =
        std::ldexp(sample_uniform(rng) - 0.5, static_cast<int>(sample_u32(rng) % 600) - 300);
    const Document read = parse_document(format_document(Document(value)), "n");
    EXPECT_EQ(as_number(read), value);
  }
}

}  // namespace
}  // namespace parian
