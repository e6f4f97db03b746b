// JSON text to documents and back. Readers know file, line and JSON pointer of every error.
#pragma once

#include <string>
#include <string_view>

#include "base/document.h"

namespace parian {

// Strict JSON (RFC 8259): at most 64 MiB of text, nesting at most 64, 512 MiB in memory; a key
// twice in an object is an error. `name` is how errors name the text. Syntax errors name line and
// column (in bytes, from 1), all others the JSON pointer.
Document parse_document(std::string_view text, const std::string& name);
Document load_document(const std::string& path);

// Two-space indentation, arrays without containers on one line; numbers with the shortest digits
// that read back to the same double; NaN and infinities become null.
std::string format_document(const Document& document);
void save_document(const std::string& path, const Document& document);

}  // namespace parian
