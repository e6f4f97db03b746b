// What a table says about how it was made.
#pragma once

#include <string>

#include "base/document.h"

namespace parian {

// A document as JSON text in one line, without spaces.
std::string format_compact(const Document& document);

// {"kind":<engine>,"simulated":true,<how>,"sample":<description>} as compact JSON text.
std::string make_provenance(const std::string& engine, const Document::Object::value_type& how,
                            const Document& description);

}  // namespace parian
