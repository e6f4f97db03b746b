#include "bench/common/bench_table.h"

#include <cstdio>
#include <filesystem>

#include "acquire/sample.h"
#include "base/error.h"
#include "io/hdf5/table_file.h"
#include "io/json/json.h"

namespace parian {

std::string make_bench_table(const std::string& sample) {
  const std::filesystem::path folder = std::filesystem::path(PARIAN_SOURCE_DIR) / "out" / "bench";
  const std::filesystem::path path = folder / (sample + ".h5");
  if (std::filesystem::exists(path)) return path.string();
  std::filesystem::create_directories(folder);
  std::fprintf(stderr, "simulating %s\n", path.c_str());
  const std::string description =
      std::string(PARIAN_SOURCE_DIR) + "/data/samples/" + sample + ".json";
  const ImageLoader no_images = [](const std::string& name) -> Image {
    throw Error({name, {}, "a sample without images", {}});
  };
  const auto source = make_analytic_source(read_sample(load_document(description), no_images));
  const auto sink = create_table(path.string(), source->header());
  copy_slices(*source, *sink);
  return path.string();
}

}  // namespace parian
