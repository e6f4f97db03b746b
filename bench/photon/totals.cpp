// Reflected and transmitted totals beside exact ones.
#include <fmt/format.h>

#include <cmath>

#include "bench/photon/study.h"

namespace parian::photon {
namespace {

std::string format_pair(const PhotonEstimate& found, double exact) {
  return fmt::format("{:.5f} ({:+.1f})", found.value, (found.value - exact) / found.error);
}

// H functions and Fresnel by a linear solve; the diffuse part alone.
void write_half_space(const Page& page) {
  constexpr double eta[] = {1, 1.3, 1.4, 1.5};
  constexpr struct {
    double albedo, exact[4];
  } rows[] = {{0.5, {.11523, .06241, .05230, .04425}},  {0.8, {.28525, .17824, .15305, .13198}},
              {0.9, {.41495, .28578, .25060, .21992}},  {0.95, {.53554, .40088, .35913, .32112}},
              {0.98, {.67108, .54782, .50378, .46147}}, {0.99, {.75272, .64539, .60359, .56198}},
              {0.999, {.91285, .85675, .83012, .80146}}};
  MarkdownTable table{{"albedo", "η = 1", "1.3", "1.4", "1.5"}, {}};
  int cells = 0, inside = 0;
  double squares = 0, worst = 0;
  for (const auto& row : rows) {
    std::vector<std::string> cellsOfRow{fmt::format("{}", row.albedo)};
    for (int k = 0; k < 4; ++k) {
      const Totals totals = measure_totals(make_homogeneous(1 - row.albedo, row.albedo, 0, eta[k]),
                                           PhotonEntry::normal, 320000);
      const double z = (totals.reflected.value - row.exact[k]) / totals.reflected.error;
      cellsOfRow.push_back(format_pair(totals.reflected, row.exact[k]));
      ++cells, inside += std::abs(z) <= 3 ? 1 : 0;
      squares += z * z;
      worst = std::max(worst, std::abs(z));
    }
    table.rows.push_back(cellsOfRow);
  }
  write_table(page, "totals",
              fmt::format("Diffuse reflectance of the half-space, in brackets the distance from "
                          "the exact value in standard errors: {} of {} within 3, the largest "
                          "{:.1f}, the mean square {:.2f}.",
                          inside, cells, worst, squares / cells),
              table);
}

void write_slabs(const Page& page) {
  MarkdownTable table{{"slab, η = 1", "R", "exact", "T", "exact"}, {}};
  const struct {
    double albedo, g, b, reflected, transmitted;
  } slabs[] = {{1, 0, 1, .34133, .65867},
               {1, 0.5, 1, .17611, .82389},
               {0.9, 0.5, 1, -1, .73909},
               {0.9, 0.75, 2, .09739, .66096}};
  for (const auto& slab : slabs) {
    const Totals totals =
        measure_totals(make_homogeneous(1 - slab.albedo, slab.albedo, slab.g, 1, slab.b),
                       PhotonEntry::normal, 1000000);
    const bool listed = slab.reflected > 0;
    table.rows.push_back({fmt::format("albedo {}, g {}, thickness {}", slab.albedo, slab.g, slab.b),
                          listed ? format_pair(totals.reflected, slab.reflected)
                                 : fmt::format("{:.5f}", totals.reflected.value),
                          listed ? fmt::format("{:.5f}", slab.reflected) : "not listed",
                          format_pair(totals.transmitted, slab.transmitted),
                          fmt::format("{:.5f}", slab.transmitted)});
  }
  write_table(page, "slabs", "Slabs, thickness in mean free paths:", table);
}

}  // namespace

void study_totals(const Page& page) {
  write_half_space(page);
  write_slabs(page);
}

}  // namespace parian::photon
