// The demo: bundled samples taken all the way, and a page that shows it.
#pragma once

#include <string>

#include "base/progress.h"

namespace parian {

struct DemoParams {
  std::string data;                 // folder of the bundled samples
  std::string folder = "out/demo";  // where results go
  std::string assets;               // folder of fetched meshes and environments, may be empty
  bool small = false;               // a small chessboard and small pictures
};

// Writes tables, maps, reports, pictures and index.html; returns the page's path.
std::string make_demo(const DemoParams& params, const Progress& progress);

// Where the bundled data are: beside an installed program, else in the source tree.
std::string find_data_folder();

}  // namespace parian
