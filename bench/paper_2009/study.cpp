#include "bench/paper_2009/study.h"

#include <fmt/format.h>

#include <cstdio>

#include "acquire/sample.h"
#include "base/error.h"
#include "base/stopwatch.h"
#include "image/image.h"
#include "io/json/json.h"
#include "material/material.h"

namespace parian::paper_2009 {

Document load_sample(const std::string& name) {
  return load_document(std::string(PARIAN_SOURCE_DIR) + "/data/samples/" + name + ".json");
}

BssrdfTable simulate(const Document& description) {
  const ImageLoader no_images = [](const std::string& path) -> Image {
    throw Error({path, {}, "a sample without images", {}});
  };
  return read_table(*make_analytic_source(read_sample(description, no_images)));
}

const BssrdfTable& get_sample(Study& study, const std::string& name) {
  if (study.sample == name) return study.table;
  study.table = {};
  study.sample.clear();
  std::fprintf(stderr, "simulating %s\n", name.c_str());
  study.table = simulate(load_sample(name));
  study.sample = name;
  return study.table;
}

FitParams paper_params() {
  FitParams params;
  params.segments = 24;
  params.lambda = 0.01;
  params.weight = PairWeight::uniform;
  params.monotone = false;
  return params;
}

Judged fit_and_judge(const BssrdfTable& table, const FitParams& params) {
  const auto source = make_slices(table);
  const Stopwatch watch;
  Judged judged{fit_profiles(*source, params), {}};
  judged.seconds = watch.seconds();
  const Material material = judged.fit.map;
  judged.errors = compare(*source, *make_slices(material, table.header), judged.fit.map.hold_out);
  std::size_t touched = 0;
  for (const FitChannelReport& channel : judged.fit.report.channels)
    touched += channel.profiles_touched;
  judged.touched = static_cast<double>(touched) /
                   static_cast<double>(table.header.pixels() * judged.fit.report.channels.size());
  return judged;
}

}  // namespace parian::paper_2009
