// The command line as a whole: finds the command, binds its flags, runs it, reports errors.
#pragma once

namespace parian {

// The exit status: 0, 1 (the work failed) or 2 (wrong usage).
int run_cli(int argc, const char* const* argv);

}  // namespace parian
