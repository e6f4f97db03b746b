// The command line of benchmarks that are made of studies.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "bench/common/page.h"

namespace parian {

struct NamedStudy {
  std::string name;
  std::function<void(const Page&)> run;
  bool in_all = true;
};

// PROGRAM [all|STUDY...] [-o FOLDER] [--docs DOCS]: runs what was asked for, by default all, in the
// order of the list, for docs/<page>.md. Prints what is thrown; returns the exit status.
int run_studies(int argc, char** argv, const std::string& page,
                const std::vector<NamedStudy>& studies);

}  // namespace parian
