// The program's entry. `--portable` starts the program once more with the C library's fused
// multiply-add variants turned off: they are all of libm whose bits differ between processors, and
// Parian's own kernels give the same bits for every instruction set.
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "app/cli/cli.h"
#include "app/cli/interrupt.h"
#include "base/memory.h"

namespace {

constexpr const char* done_marker = "PARIAN_PORTABLE";

bool asks_for_portable(int argc, char** argv) {
  for (int i = 1; i < argc; ++i)
    if (std::strcmp(argv[i], "--portable") == 0) return std::getenv(done_marker) == nullptr;
  return false;
}

// Names with _Usable are those of glibc before 2.33; unknown names are ignored.
void restart_portable(char** argv) {
  setenv(done_marker, "1", 1);
  setenv("GLIBC_TUNABLES", "glibc.cpu.hwcaps=-FMA,-FMA4,-FMA_Usable,-FMA4_Usable", 1);
  execv("/proc/self/exe", argv);
}

}  // namespace

int main(int argc, char** argv) {
  if (asks_for_portable(argc, argv)) {
    restart_portable(argv);
    std::fputs(
        "parian: error: --portable: expected to start the program again, found no "
        "/proc/self/exe\n",
        stderr);
    return 1;
  }
  parian::keep_freed_memory();
  parian::catch_interrupts();
  return parian::run_cli(argc, argv);
}
