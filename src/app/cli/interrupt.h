// Ctrl-C and SIGTERM as a flag that progress reads, so that work stops between two steps and
// unfinished files are removed.
#pragma once

namespace parian {

void catch_interrupts();
bool was_interrupted();

}  // namespace parian
