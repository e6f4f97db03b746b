#include "base/check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/test_errors.h"

namespace parian {
namespace {

TEST(Check, PrintsBothOperands) {
  const int rows = 3;
  const Error error = catch_error([&] { PARIAN_CHECK_EQ(rows, 4); });
  EXPECT_EQ(error.kind, ErrorKind::contract);
  EXPECT_THAT(error.what(), testing::HasSubstr("expected rows == 4, found 3 and 4"));
  PARIAN_CHECK_LT(0.5, 1.0);
}

}  // namespace
}  // namespace parian
