// What commands say: a summary for people, figures for programs.
#pragma once

#include <string>

#include "app/cli/command.h"

namespace parian {

// To standard output, unless --quiet or the figures go there.
void print_summary(const Context& context, const std::string& text);

// As --json says.
void write_figures(const Context& context, const Document& figures);

// Provenance as a document: parsed where it is JSON, the text itself where it is not, else null.
Document read_provenance(const std::string& text);

}  // namespace parian
