#include "base/progress.h"

#include "base/error.h"

namespace parian {

void advance_progress(const Progress& progress, std::string_view stage, double done) {
  if (progress.is_cancelled && progress.is_cancelled()) throw make_cancelled_error();
  if (progress.report) progress.report(stage, done);
}

}  // namespace parian
