// What a simulated table says about itself.
#pragma once

#include <string>

#include "base/document.h"

namespace parian {

// {"kind":"analytic","simulated":true,...,"sample":<description>} as compact JSON text.
std::string make_provenance(const Document& description);

}  // namespace parian
