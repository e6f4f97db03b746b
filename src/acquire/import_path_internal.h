// Paths that descriptions of imports name. Private to acquire.
#pragma once

#include <string>

#include "base/document.h"

namespace parian {

// A path counts from the folder of the document's file.
inline std::string path_beside(const Document& document, const std::string& path) {
  const std::size_t slash =
      document.file != nullptr ? document.file->rfind('/') : std::string::npos;
  if (slash == std::string::npos || path.starts_with('/')) return path;
  return document.file->substr(0, slash + 1) + path;
}

}  // namespace parian
