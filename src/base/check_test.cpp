#include "base/check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.h"

namespace parian {
namespace {

TEST(Check, PrintsBothOperands) {
  const int rows = 3;
  try {
    PARIAN_CHECK_EQ(rows, 4);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind, ErrorKind::contract);
    EXPECT_THAT(error.what(), testing::HasSubstr("expected rows == 4, found 3 and 4"));
  }
  PARIAN_CHECK_LT(0.5, 1.0);
}

}  // namespace
}  // namespace parian
