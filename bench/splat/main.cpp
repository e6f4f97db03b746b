// Splatting, for docs/splatting.md.
#include <fmt/format.h>

#include "bench/common/studies.h"
#include "bench/splat/study.h"

int main(int argc, char** argv) {
  using namespace parian;
  const auto in_context = [](void (*study)(const Page&, const GlLimits&)) {
    return [study](const Page& page) {
      const OffscreenContext context;
      fmt::print("{}, {}\n", context.limits().renderer, context.limits().version);
      study(page, context.limits());
    };
  };
  return run_studies(argc, argv, "splatting",
                     {{"speed", in_context(study_speed)},
                      {"samples", in_context(study_samples)},
                      {"edit", in_context(study_edits)},
                      {"live", in_context(study_live)},
                      {"accuracy", in_context(study_accuracy)},
                      {"pictures", in_context(study_pictures)}});
}
