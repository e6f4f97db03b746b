// Editing: every operation on a 222 x 222 x 3 map with 25 knots, in ms and as a ratio to one pass
// over the map's memory.
//
//   ./run bench edit [--docs docs]
#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <functional>
#include <map>
#include <numeric>

#include "base/memory.h"
#include "base/parallel.h"
#include "base/random.h"
#include "bench/common/studies.h"
#include "bench/common/timing.h"
#include "edit/adjust.h"
#include "edit/blend.h"
#include "edit/bound.h"
#include "edit/geometry.h"
#include "edit/neighbours.h"
#include "edit/paste.h"
#include "edit/propagate.h"
#include "edit/propagate_all_pairs.h"
#include "edit/session.h"
#include "edit/shape_edit.h"
#include "edit/smooth.h"

namespace parian {
namespace {

constexpr int side = 222, knots = 25;

// Cells of four materials with noise over them, as a fit of a stone has.
ProfileMap make_map() {
  std::vector<double> radii;
  radii.reserve(knots);
  for (int k = 0; k < knots; ++k) radii.push_back(0.25 * k);
  ProfileMap map = make_profile_map(side, side, 3, 0.25, radii);
  Rng rng = make_rng(1);
  std::vector<std::array<double, 3>> cells;  // place and material
  cells.reserve(150);
  for (int i = 0; i < 150; ++i)
    cells.push_back({side * sample_uniform(rng), side * sample_uniform(rng),
                     std::floor(4 * sample_uniform(rng))});
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      const auto nearest = std::min_element(cells.begin(), cells.end(), [&](auto& a, auto& b) {
        return std::hypot(a[0] - x, a[1] - y) < std::hypot(b[0] - x, b[1] - y);
      });
      const double material = (*nearest)[2], noise = 0.1 * sample_normal(rng);
      for (int c = 0; c < 3; ++c)
        for (int k = 0; k < knots; ++k)
          knot_plane(map, c, k)[y * side + x] = static_cast<float>(
              -1 - 0.3 * material * (c - 1) + noise -
              (0.8 + 0.3 * material + 0.1 * c) * radii[static_cast<std::size_t>(k)]);
    }
  return map;
}

struct Row {
  std::string name;
  double target_ms = 0;  // 0: none
  double ms = 0;
};

double best_ms(int runs, const std::function<void()>& work) {
  return 1e3 * best_seconds(runs, work);
}

// Reads all profiles and writes them elsewhere, on all cores.
void copy_map(const EditState& state, AlignedVector<float>& to) {
  const auto& from = state.shapes->log_profile;
  parallel_for_blocks(from.size(), 1u << 16u, [&](std::size_t begin, std::size_t end) {
    std::memcpy(&to[begin], &from[begin], (end - begin) * sizeof(float));
  });
}

Document object(Document::Object members) {
  return Document(std::move(members));
}

Document adjust_layer(double scale) {
  return object({{"operation", "adjust"}, {"albedo_scale", scale}, {"range_scale", 1.1}});
}

// Ten layers of all kinds, the third with `scale`.
Document make_recipe(double scale) {
  Document::Array points;
  points.emplace_back(Document::Array{5.0, 5.0});
  const Document selection = object(
      {{"type", "propagate"},
       {"strokes", Document::Array{object({{"points", points}, {"radius", 0.5}}),
                                   object({{"points", Document::Array{Document::Array{40.0, 30.0}}},
                                           {"radius", 0.5},
                                           {"positive", false}})}}});
  Document propagated = adjust_layer(0.9);
  set(propagated, "selection", selection);
  const Document place = object({{"at", Document::Array{20.0, 20.0}}});
  const Document blend = object({{"operation", "blend"}, {"from", place}, {"opacity", 0.5}});
  const Document paste = object(
      {{"operation", "paste"},
       {"from", object({{"min", Document::Array{5.0, 5.0}}, {"max", Document::Array{25.0, 25.0}}})},
       {"to", Document::Array{35.0, 35.0}}});
  const Document sharpen =
      object({{"operation", "filter"}, {"kind", "unsharp"}, {"sigma_mm", 1.5}});
  return object(
      {{"layers",
        Document::Array{adjust_layer(1.1), propagated, adjust_layer(scale), blend, paste, sharpen,
                        adjust_layer(0.8), object({{"operation", "shape"}, {"falloff", 1.2}}),
                        propagated, object({{"operation", "adjust"}, {"hue_deg", 20.0}})}}});
}

struct Bench {
  EditState state = make_edit_state(make_map());
  Mask mask = make_mask(side, side, 0.5f);
  EditReport report;
  std::vector<Row> rows;
  double pass_ms = 0;

  // A copy of the state is a few pointers.
  void add(const std::string& name, double target_ms, const std::function<void(EditState&)>& work,
           int runs = 12) {
    rows.push_back({name, target_ms, best_ms(runs, [&] {
                      EditState copy = state;
                      work(copy);
                    })});
  }
};

void measure_operations(Bench& bench) {
  Adjust adjust;
  adjust.albedo_scale = {1.2, 0.9, 0.8};
  adjust.albedo_offset = {0.01};
  adjust.range_scale = {0.8};
  Adjust hue;
  hue.color.hue_deg = 40;
  const Mask& mask = bench.mask;
  EditReport& report = bench.report;
  bench.add("scale and offset of albedo and range", 10,
            [&](EditState& s) { apply(adjust, s, mask, report); });
  bench.add("hue (OKLCh)", 10, [&](EditState& s) { apply(hue, s, mask, report); });
  const EditState picked = gather_pixels(bench.state, {4711}, 1, 1);
  bench.add("blend with a profile: albedo and range", 10, [&](EditState& s) {
    apply({1, 1, 0}, picked, {}, s, mask, report);
  });
  bench.add("blend with a profile: albedo, range, shape", 10, [&](EditState& s) {
    apply({1, 1, 1}, picked, {}, s, mask, report);
  });
  std::vector<std::uint32_t> mirrored(bench.state.pixels());
  std::iota(mirrored.rbegin(), mirrored.rend(), 0u);
  bench.add("blend with a map, pixel by pixel", 0, [&](EditState& s) {
    apply({1, 1, 1}, bench.state, mirrored, s, mask, report);
  });
  ShapeEdit shape;
  shape.falloff = 1.3;
  shape.scale = {{0, 1}, {0.4, 1.5}, {1, 0.7}};
  bench.add("shape curve", 10, [&](EditState& s) { apply(shape, s, mask); });
  FilterParams filter;
  filter.sigma_mm = 6 * 0.25;
  filter.kind = FilterKind::unsharp;
  bench.add("unsharp, 6 px", 100, [&](EditState& s) { apply(filter, s, mask, report); });
  filter.kind = FilterKind::bilateral;
  bench.add(
      "bilateral, 6 px", 100, [&](EditState& s) { apply(filter, s, mask, report); }, 5);
  PasteParams paste;
  paste.keep_mean = true;
  const Pattern pattern = make_pattern(flip(bench.state, true, false));
  bench.add(
      "Poisson paste over the whole map", 60,
      [&](EditState& s) {
        apply(paste, pattern, {111, 111}, s, mask, report);
      },
      8);
}

void measure_selections(Bench& bench) {
  const ProfileMap map = make_profile_map(bench.state);
  bench.add(
      "features of Eq. 11", 0, [&](EditState&) { make_profile_features(map); }, 5);
  const Features features = make_profile_features(map);
  bench.add(
      "neighbour graph", 400, [&](EditState&) { make_neighbour_graph(features); }, 5);
  const NeighbourGraph graph = make_neighbour_graph(features);
  std::vector<StrokePixel> pixels;
  for (std::uint32_t i = 0; i < 40; ++i) {
    pixels.push_back({50u * side + 40 + i, 1, 0});
    pixels.push_back({160u * side + 120 + i, 1, 1});
  }
  bench.add("propagation of two strokes", 60,
            [&](EditState&) { propagate(graph, features, pixels, 2); });
  bench.add(
      "all-pairs propagation, 200 columns", 0,
      [&](EditState&) { propagate_all_pairs(features, pixels, 2); }, 3);
}

void measure_sessions(Bench& bench) {
  const ProfileMap map = make_map();
  bench.add(
      "a map becomes a session", 0, [&](EditState&) { make_edit_session(map, {}); }, 5);
  EditSession session = make_edit_session(map, {});
  set_recipe(session, make_recipe(1.0));
  bench.add(
      "ten layers for the first time", 0, [&](EditState&) { evaluate(session); }, 1);
  double scale = 1.0;
  bench.add("the third of ten layers changed", 150, [&](EditState&) {
    scale += 0.01;
    set_recipe(session, make_recipe(scale));
    evaluate(session);
  });
  bool back = false;
  bench.add("undo or redo", 5, [&](EditState&) {
    back = !back;
    if (back)
      undo(session);
    else
      redo(session);
    evaluate(session);
  });
}

MarkdownTable make_table(const Bench& bench) {
  MarkdownTable table;
  table.header = {"", "ms", "target", "passes over the map"};
  for (const Row& row : bench.rows)
    table.rows.push_back({row.name, fmt::format("{:.1f}", row.ms),
                          row.target_ms > 0 ? fmt::format("≤ {:.0f}", row.target_ms) : "",
                          fmt::format("{:.1f}", row.ms / bench.pass_ms)});
  return table;
}

void study_operations(const Page& page) {
  Bench bench;
  AlignedVector<float> copy(bench.state.shapes->log_profile.size());
  bench.pass_ms = best_ms(20, [&] { copy_map(bench.state, copy); });
  measure_operations(bench);
  measure_selections(bench);
  measure_sessions(bench);
  write_table(page, "timings",
              fmt::format("A map of {0} × {0} pixels, 3 channels and {1} knots; masks of 1/2 "
                          "everywhere; two cores; the best of several runs. One pass over the "
                          "map's {2:.1f} MB, read and written, takes {3:.1f} ms.",
                          side, knots, 4e-6 * static_cast<double>(copy.size()), bench.pass_ms),
              make_table(bench));
}

}  // namespace
}  // namespace parian

int main(int argc, char** argv) {
  parian::keep_freed_memory();  // as the program does
  return parian::run_studies(argc, argv, "editing", {{"operations", parian::study_operations}});
}
