#include "base/check.h"

#include <fmt/format.h>

#include "base/error.h"

namespace parian {

void fail_check(const char* file, int line, const char* expression, const std::string& left,
                const std::string& right) {
  std::string found = left.empty() ? "false" : fmt::format("{} and {}", left, right);
  throw Error({fmt::format("{}:{}", file, line), "contract", expression, std::move(found)},
              ErrorKind::contract);
}

std::string describe_operand(double value) {
  return fmt::format("{}", value);
}
std::string describe_operand(long long value) {
  return fmt::format("{}", value);
}
std::string describe_operand(unsigned long long value) {
  return fmt::format("{}", value);
}

}  // namespace parian
