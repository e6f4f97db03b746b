// Autosave: the recipe and what it belongs to, kept until the program ends as it should.
#pragma once

#include <string>

#include "app/studio/studio.h"

namespace parian {

void write_autosave(const Studio& studio);
void remove_autosave(const Studio& studio);
// Where it lies; empty without a folder for state.
std::string autosave_path(const StudioPaths& paths);

}  // namespace parian
