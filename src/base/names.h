// Names that a person typed: the nearest known one, for "did you mean".
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace parian {

// The known name with the least edit distance (insert, delete, replace, swap of neighbours), or
// empty when none is closer than half of the name's length. Ties go to the earlier name.
std::string nearest_name(std::string_view name, const std::vector<std::string>& known);

// "'a', 'b' or 'c'"
std::string list_names(const std::vector<std::string>& names);

}  // namespace parian
