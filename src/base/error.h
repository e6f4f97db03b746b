// The one exception type of Parian: what went wrong, where, what was expected and what was found.
#pragma once

#include <stdexcept>
#include <string>

namespace parian {

enum class ErrorKind {
  input,      // a file, value or parameter is wrong
  usage,      // the command line is wrong
  resource,   // a file cannot be written, memory or disk is full
  cancelled,  // the caller asked to stop
  contract,   // a caller broke a documented precondition: a bug
};

// Every part may be empty; what() joins those that are not:
//   "FILE: PLACE: expected EXPECTED, found FOUND"
struct ErrorParts {
  std::string file;      // as the user named it
  std::string place;     // line, dataset, attribute, axis, index, JSON pointer, parameter
  std::string expected;  // a noun phrase
  std::string found;     // a noun phrase, or the value
};

class Error : public std::runtime_error {
 public:
  explicit Error(ErrorParts parts, ErrorKind kind = ErrorKind::input);

  ErrorParts parts;
  ErrorKind kind;
};

// The error that cancelled work throws; its message is "cancelled".
Error make_cancelled_error();

}  // namespace parian
