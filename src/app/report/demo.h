// The demo: bundled samples taken all the way, and a page that shows it.
#pragma once

#include <string>

#include "base/progress.h"

namespace parian {

// Writes tables, maps, reports, pictures and index.html into `folder`; returns the page's path.
// `data` holds the bundled samples.
std::string make_demo(const std::string& data, const std::string& folder, const Progress& progress);

// Where the bundled data are: beside an installed program, else in the source tree.
std::string find_data_folder();

}  // namespace parian
