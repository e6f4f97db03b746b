// Peak memory of the fit, each size in a process of its own, on tables that exist only slice by
// slice.
//
//   ./run bench memory
#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <limits>

#include "base/error.h"
#include "base/memory.h"
#include "fit/fit.h"
#include "material/bssrdf_table.h"

namespace parian {
namespace {

// A heterogeneous table without storage.
class FormulaSource : public SliceSource {
 public:
  FormulaSource(int size, double radius) {
    header_.width = header_.height = size;
    header_.pixel_pitch_mm = 0.5;
    header_.offsets = half_disc_offsets(radius, size, size);
  }
  const TableHeader& header() const override { return header_; }
  std::string name() const override { return "formula"; }
  void read_slice(int channel, int offset_index, float* slice) const override {
    const Offset d = header_.offsets[static_cast<std::size_t>(offset_index)];
    const double r = length_px(d);
    const float dark = static_cast<float>(0.1 * std::exp(-0.3 * r - 0.01 * channel)),
                bright = 2 * dark;
    const auto tile = [](int x, int y) { return ((x / 20) + (y / 20)) % 2; };
    for (int y = 0; y < header_.height; ++y)
      for (int x = 0; x < header_.width; ++x)
        *slice++ = tile(x, y) + tile(x + d.dx + 20, y + d.dy) > 0 ? bright : dark;
    clean_slice(header_, name(), channel, offset_index, slice - header_.pixels());
  }

 private:
  TableHeader header_;
};

// Peak resident bytes of a child process that runs the fit, less what the process weighs without.
std::size_t measure(int size, double radius, int segments) {
  int channel[2];
  if (pipe(channel) != 0) throw Error({.place = "pipe", .found = "failed"});
  const pid_t child = fork();
  if (child == 0) {
    keep_freed_memory();
    FitParams params;
    params.segments = segments;
    params.max_iterations = 3;  // memory does not grow with iterations
    const FitResult result = fit_profiles(FormulaSource(size, radius), params);
    const std::size_t peak = result.map.log_profile.empty() ? 0 : peak_memory();
    _exit(write(channel[1], &peak, sizeof(peak)) == sizeof(peak) ? 0 : 1);
  }
  close(channel[1]);
  std::size_t peak = 0;
  const bool complete = read(channel[0], &peak, sizeof(peak)) == sizeof(peak);
  close(channel[0]);
  int status = 0;
  waitpid(child, &status, 0);
  if (!complete || status != 0)
    throw Error({.place = fmt::format("{} pixels, radius {}", size, radius), .found = "failed"});
  return peak;
}

void report(int size, double radius, int segments) {
  const std::size_t peak = measure(size, radius, segments);
  const double unknowns = static_cast<double>(size) * size * (segments + 1);
  fmt::print("{:>5}  {:>6}  {:>8}  {:>9.0f}  {:>18.1f}\n", size, radius, segments,
             static_cast<double>(peak) / 1e6, static_cast<double>(peak) / unknowns);
  std::fflush(stdout);
}

}  // namespace
}  // namespace parian

int main() {
  try {
    fmt::print(
        "three channels; targets: 600 MB for 222 at any radius; 128 bytes per unknown of one "
        "channel beyond\n");
    fmt::print("{:>5}  {:>6}  {:>8}  {:>9}  {:>18}\n", "size", "radius", "segments", "peak MB",
               "bytes per unknown");
    parian::report(222, 24, 24);
    parian::report(222, 60, 24);
    parian::report(222, 312, 24);
    parian::report(512, 24, 24);
    parian::report(1024, 16, 16);
  } catch (const parian::Error& error) {
    fmt::print(stderr, "bench: error: {}\n", error.what());
    return 1;
  }
}
