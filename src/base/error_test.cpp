#include "base/error.h"

#include <gtest/gtest.h>

namespace parian {
namespace {

TEST(Error, JoinsThePartsThatAreThere) {
  EXPECT_STREQ(Error({"a.h5", "attribute 'version'", "1", "2"}).what(),
               "a.h5: attribute 'version': expected 1, found 2");
  EXPECT_STREQ(Error({.place = "segments", .found = "too many"}).what(), "segments: too many");
  EXPECT_STREQ(Error({.file = "x", .expected = "a table"}).what(), "x: expected a table");
  EXPECT_STREQ(make_cancelled_error().what(), "cancelled");
  EXPECT_EQ(make_cancelled_error().kind, ErrorKind::cancelled);
}

}  // namespace
}  // namespace parian
