// Contract checks that stay on in release builds and print both operands. They guard against
// callers' bugs; bad input from outside throws a described Error instead.
#pragma once

#include <string>

namespace parian {

[[noreturn]] void fail_check(const char* file, int line, const char* expression,
                             const std::string& left, const std::string& right);
std::string describe_operand(double value);
std::string describe_operand(long long value);
std::string describe_operand(unsigned long long value);

template <typename T>
std::string describe_any_operand(T value) {
  if constexpr (static_cast<T>(0.5) != T{0}) {
    return describe_operand(static_cast<double>(value));
  } else if constexpr (static_cast<T>(-1) < T{0}) {
    return describe_operand(static_cast<long long>(value));
  } else {
    return describe_operand(static_cast<unsigned long long>(value));
  }
}

}  // namespace parian

#define PARIAN_CHECK(condition)                                                     \
  do {                                                                              \
    if (!(condition)) ::parian::fail_check(__FILE__, __LINE__, #condition, "", ""); \
  } while (false)

#define PARIAN_CHECK_OP(a, op, b)                                     \
  do {                                                                \
    const auto parian_a = (a);                                        \
    const auto parian_b = (b);                                        \
    if (!(parian_a op parian_b))                                      \
      ::parian::fail_check(__FILE__, __LINE__, #a " " #op " " #b,     \
                           ::parian::describe_any_operand(parian_a),  \
                           ::parian::describe_any_operand(parian_b)); \
  } while (false)

#define PARIAN_CHECK_EQ(a, b) PARIAN_CHECK_OP(a, ==, b)
#define PARIAN_CHECK_LT(a, b) PARIAN_CHECK_OP(a, <, b)
#define PARIAN_CHECK_LE(a, b) PARIAN_CHECK_OP(a, <=, b)
