#include "base/error.h"

#include <utility>

namespace parian {
namespace {

std::string join(const ErrorParts& parts) {
  std::string text;
  const auto append = [&](const std::string& part, const char* separator) {
    if (part.empty()) return;
    if (!text.empty()) text += separator;
    text += part;
  };
  append(parts.file, "");
  append(parts.place, ": ");
  if (!parts.expected.empty()) append("expected " + parts.expected, ": ");
  if (!parts.found.empty())
    append(parts.expected.empty() ? parts.found : "found " + parts.found,
           parts.expected.empty() ? ": " : ", ");
  return text;
}

}  // namespace

Error::Error(ErrorParts parts_, ErrorKind kind_)
    : std::runtime_error(join(parts_)), parts(std::move(parts_)), kind(kind_) {}

Error make_cancelled_error() {
  return Error({.found = "cancelled"}, ErrorKind::cancelled);
}

}  // namespace parian
