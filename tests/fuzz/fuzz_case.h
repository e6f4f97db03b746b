// One case of the fuzzer: its random numbers, its folder, and the readers that it can try. Each
// mutates an input of its own, reads it and lets whatever the reader throws escape.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "base/document.h"
#include "base/random.h"

namespace parian::fuzz {

struct Case {
  Rng rng;
  std::string folder;
  std::string description;  // what was done to the input

  std::size_t below(std::size_t count) { return sample_u32(rng) % count; }
  bool one_in(std::size_t count) { return below(count) == 0; }
  template <typename T>
  T pick(const std::vector<T>& values) {
    return values[below(values.size())];
  }
  void note(const std::string& text) { description += description.empty() ? text : ", " + text; }
  std::string at(const char* name) const { return folder + "/" + name; }
};

// Numbers at the edges of what readers accept; all finite, as JSON has no others.
inline double odd_number(Case& c) {
  return c.pick<double>(
      {0,     -0.0, 1,   -1,         0.5,           1.5,          2,    3,     64,     65535,
       65536, 1e6,  1e9, 2147483647, -2147483648.0, 4294967296.0, 1e18, 1e300, -1e300, 1e-300,
       5e-324});
}

void fuzz_json(Case& c);
void fuzz_params(Case& c);
void fuzz_sample(Case& c);
void fuzz_recipe(Case& c);
// Changes one value, key or element somewhere in the document.
void mutate_document(Case& c, Document& document);
void fuzz_table(Case& c);
void fuzz_map(Case& c);
void fuzz_transport(Case& c);
void fuzz_photons(Case& c);
void fuzz_image(Case& c);
void fuzz_npy(Case& c);
void fuzz_mesh(Case& c);
void fuzz_blend(Case& c);

}  // namespace parian::fuzz
