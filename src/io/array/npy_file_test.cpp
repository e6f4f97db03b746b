#include "io/array/npy_file.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/test_errors.h"

namespace parian {
namespace {

// As numpy.save writes it: magic, version, length, literal padded with spaces, data.
std::string make_npy(const std::string& literal, const std::string& data, char version = 1) {
  std::string bytes = "\x93NUMPY";
  bytes += version;
  bytes += '\0';
  bytes += static_cast<char>(literal.size());
  bytes += '\0';
  if (version > 1) bytes += std::string(2, '\0');
  return bytes + literal + data;
}
std::string make_header(const std::string& descr, const std::string& shape,
                        const std::string& order = "False") {
  return "{'descr': '" + descr + "', 'fortran_order': " + order + ", 'shape': " + shape + ", }  \n";
}
std::string error_of(const std::string& bytes) {
  return parian::error_of([&] { parse_npy(bytes, "a.npy"); });
}
using namespace std::string_literals;

TEST(Npy, ReadsNumbersOfEveryWidthAndOrder) {
  const auto value = [](const char* descr, const std::string& data, char version = 1) {
    return parse_npy(make_npy(make_header(descr, "(1,)"), data, version), "a.npy").values.at(0);
  };
  EXPECT_EQ(value("<f4", "\x00\x00\x20\xc0"s), -2.5f);
  EXPECT_EQ(value(">f4", "\xc0\x20\x00\x00"s), -2.5f);
  EXPECT_EQ(value("<f8", "\0\0\0\0\0\0\x04\xc0"s, 2), -2.5f);
  EXPECT_EQ(value("<f2", "\x00\xc1"s, 3), -2.5f);
  EXPECT_EQ(value("<f2", "\x01\x00"s), std::ldexp(1.0f, -24));
  EXPECT_TRUE(std::isnan(value("<f2", "\x01\x7c"s)));
  EXPECT_EQ(value("<f2", "\x00\xfc"s), -INFINITY);
  EXPECT_EQ(value("|u1", "\xff"), 255);
  EXPECT_EQ(value("|i1", "\xff"), -1);
  EXPECT_EQ(value("<i2", "\xfe\xff"), -2);
  EXPECT_EQ(value(">u2", "\x01\x02"s), 258);
  EXPECT_EQ(value("<i8", "\xff\xff\xff\xff\xff\xff\xff\xff"), -1);
}

TEST(Npy, FortranOrderIsTransposed) {
  const std::string data("\0\1\2\3\4\5", 6);
  const NpyArray c = parse_npy(make_npy(make_header("|u1", "(2, 3)"), data), "a.npy");
  const NpyArray f = parse_npy(make_npy(make_header("|u1", "(2, 3)", "True"), data), "a.npy");
  EXPECT_EQ(c.shape, (std::vector<std::size_t>{2, 3}));
  EXPECT_EQ(c.values, (std::vector<float>{0, 1, 2, 3, 4, 5}));
  EXPECT_EQ(f.values, (std::vector<float>{0, 2, 4, 1, 3, 5}));
}

TEST(Npy, BadFilesSayWhatIsWrong) {
  EXPECT_EQ(error_of("hello"), "a.npy: expected a .npy file, found no NumPy signature");
  EXPECT_EQ(error_of(make_npy(make_header("<f4", "(1,)"), "1234", 9)),
            "a.npy: header: expected version 1, 2 or 3, found 9");
  EXPECT_EQ(error_of(make_npy(make_header("<f4", "(1,)"), "").substr(0, 30)),
            "a.npy: expected a whole .npy file, found a truncated one");
  EXPECT_EQ(error_of(make_npy(make_header("<f4", "(2, 3)"), "1234")),
            "a.npy: data: expected 24 bytes, as shape [2][3] needs, found 4");
  EXPECT_EQ(error_of(make_npy(make_header("<c8", "(1,)"), "12345678")),
            "a.npy: header: expected a number type such as '<f4', found '<c8'");
  EXPECT_EQ(error_of(make_npy(make_header("<f4", "(0,)"), "")),
            "a.npy: header: expected 1 to 4294967296 numbers, found shape [0]");
  EXPECT_EQ(
      error_of(make_npy(make_header("<f4", "(4000000000, 4000000000)"), "")),
      "a.npy: header: expected 1 to 4294967296 numbers, found shape [4000000000][4000000000]");
  EXPECT_EQ(error_of(make_npy("{'descr': [('a', '<f4')], 'shape': (1,)}", "1234")),
            "a.npy: header: expected a quoted string, found '[('a', '<f4')], 'sha'");
  EXPECT_EQ(error_of(make_npy("{'descr': '<f4', 'shape': (1,)}", "1234")),
            "a.npy: header: expected the keys 'descr', 'fortran_order' and 'shape', each once, "
            "found not all");
  EXPECT_EQ(error_of(make_npy("{'descr': '<f4', 'x': 1}", "1234")),
            "a.npy: header: expected the keys 'descr', 'fortran_order' and 'shape', each once, "
            "found another key 'x'");
}

}  // namespace
}  // namespace parian
