#include "transport/layered_field.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "base/check.h"
#include "base/parallel.h"
#include "scene/mapping.h"
#include "transport/row_blend.h"

namespace parian {
namespace {

constexpr std::size_t block = 1024;
constexpr PropertyWeights all_of_it{1, 1, 1};

// A material's rows on the common knots.
struct RowSource {
  ProfileField field;
  std::vector<Vec2> places;             // of each point in the sample, in pixels; empty: anywhere
  std::vector<std::uint32_t> segments;  // of the common knots in its own, for those inside
  std::vector<float> fractions;         // within the segment
  bool has_common_knots = false;
};

struct FieldLayer {
  PropertyWeights full;     // where the mask is 1
  std::vector<float> mask;  // of each point; empty: 1 at all of them
  const Material* material = nullptr;
  const Mapping* mapping = nullptr;
};

PropertyWeights weights_at(const FieldLayer& layer, std::size_t point) {
  if (layer.mask.empty()) return layer.full;
  const auto w = static_cast<double>(layer.mask[point]);
  return {layer.full.albedo * w, layer.full.range * w, layer.full.shape * w};
}

// Range or shape in part: new kinks between the knots.
bool is_mixture(const PropertyWeights& w) {
  return w != all_of_it && (w.range != 0 || w.shape != 0);
}

using GetPoint = std::function<SurfacePoint(std::size_t)>;

// Those that count at some point; what lies below a layer that covers all is left out.
std::vector<FieldLayer> find_layers(const Scene& scene, std::size_t count, const GetPoint& get) {
  std::vector<FieldLayer> layers(scene.layers.size());
  for (std::size_t l = 0; l < layers.size(); ++l) {
    const SurfaceLayer& layer = scene.layers[l];
    layers[l] = {
        {layer.opacity * layer.albedo, layer.opacity * layer.range, layer.opacity * layer.shape},
        std::vector<float>(count, 1),
        layer.material.get(),
        &layer.mapping};
  }
  parallel_for_blocks(count, block, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const SurfacePoint point = get(i);
      for (std::size_t l = 0; l < layers.size(); ++l)
        layers[l].mask[i] = static_cast<float>(eval_mask(scene.layers[l].mask, scene.mesh, point));
    }
  });
  std::vector<FieldLayer> kept;
  kept.push_back({all_of_it, {}, &std::get<Material>(scene.material), &scene.mapping});
  for (FieldLayer& layer : layers) {
    const auto is_one = [](float w) { return w == 1; };
    const auto is_zero = [](float w) { return w == 0; };
    if (layer.full == PropertyWeights{} ||
        std::all_of(layer.mask.begin(), layer.mask.end(), is_zero))
      continue;
    if (std::all_of(layer.mask.begin(), layer.mask.end(), is_one)) layer.mask.clear();
    if (layer.mask.empty() && layer.full == all_of_it) kept.clear();
    kept.push_back(std::move(layer));
  }
  return kept;
}

// Without the base: the lowest of the kept ones covers all.
bool has_mixtures(const std::vector<FieldLayer>& layers, std::size_t count) {
  for (const FieldLayer& layer : layers)
    for (std::size_t i = 0; i < (layer.mask.empty() ? std::min<std::size_t>(count, 1) : count); ++i)
      if (is_mixture(weights_at(layer, i))) return true;
  return false;
}

void place_points(RowSource& source, const Mapping& mapping, std::size_t count,
                  const GetPoint& get) {
  const ProfileField& field = source.field;
  if (field.width == 1 && field.height == 1) return;
  const SampleGrid grid{field.width, field.height, field.pixel_pitch_mm};
  source.places.resize(count);
  parallel_for_blocks(count, block, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const SamplePoint place = map_to_sample(mapping, grid, get(i));
      source.places[i] = {static_cast<float>(place.x), static_cast<float>(place.y)};
    }
  });
}

void prepare_knots(RowSource& source, const std::vector<float>& common) {
  const std::vector<float>& own = source.field.knots_mm;
  source.has_common_knots = own == common;
  std::uint32_t k = 0;
  for (const float r : common) {
    if (r > own.back()) break;
    while (k + 2 < own.size() && own[k + 1] <= r) ++k;
    source.segments.push_back(k);
    source.fractions.push_back((r - own[k]) / (own[k + 1] - own[k]));
  }
}

// Beyond its own knots a row goes on with its last slope, at least the least one.
void extend_row(const RowSource& source, const std::vector<float>& common, const float* own,
                float* out) {
  const std::vector<float>& knots = source.field.knots_mm;
  const std::size_t n = knots.size() - 1, inside = source.segments.size();
  for (std::size_t c = 0; c < 3; ++c) {
    const float last = own[3 * n + c];
    const float slope = std::min((last - own[3 * (n - 1) + c]) / (knots[n] - knots[n - 1]),
                                 -0.5f * static_cast<float>(min_tail_decay) / knots[n]);
    for (std::size_t k = inside; k < common.size(); ++k)
      out[3 * k + c] = last + slope * (common[k] - knots[n]);
  }
}

void eval_source(const RowSource& source, const std::vector<float>& common, std::size_t point,
                 std::vector<float>& own, ProfileRow& row) {
  const Vec2 place = source.places.empty() ? Vec2{} : source.places[point];
  own.resize(source.field.row());
  source.field.eval(static_cast<double>(place.x), static_cast<double>(place.y), own.data(),
                    row.support_mm.data());
  row.half_log.resize(3 * common.size());
  if (source.has_common_knots) {
    std::copy(own.begin(), own.end(), row.half_log.begin());
    return;
  }
  for (std::size_t k = 0; k < source.segments.size(); ++k) {
    const float* from = &own[3 * static_cast<std::size_t>(source.segments[k])];
    const float t = source.fractions[k];
    for (std::size_t c = 0; c < 3; ++c)
      row.half_log[3 * k + c] = (1 - t) * from[c] + t * from[3 + c];
  }
  extend_row(source, common, own.data(), row.half_log.data());
  if (source.field.monotone) prevent_rises(row);
}

struct LayeredRows {
  RowKnots knots;
  std::vector<FieldLayer> layers;  // the lowest covers all
  std::vector<RowSource> sources;  // of each layer
  std::size_t count = 0;
  bool monotone = true;
};

struct EvalScratch {
  ProfileRow row, over;
  std::vector<float> own;
  RowScratch blend;
};

void eval_layers(const LayeredRows& rows, std::size_t point, EvalScratch& scratch) {
  std::size_t lowest = rows.layers.size() - 1;
  while (weights_at(rows.layers[lowest], point) != all_of_it) --lowest;
  const std::vector<float>& common = rows.knots.knots_mm;
  eval_source(rows.sources[lowest], common, point, scratch.own, scratch.row);
  for (std::size_t l = lowest + 1; l < rows.layers.size(); ++l) {
    const PropertyWeights weights = weights_at(rows.layers[l], point);
    if (weights == PropertyWeights{}) continue;
    eval_source(rows.sources[l], common, point, scratch.own, scratch.over);
    blend_rows(rows.knots, scratch.row, scratch.over, weights, rows.monotone, scratch.blend);
  }
}

}  // namespace

std::optional<ProfileField> make_layered_field(const Scene& scene, std::size_t count,
                                               const GetPoint& get) {
  const auto rows = std::make_shared<LayeredRows>();
  rows->count = count;
  rows->layers = find_layers(scene, count, get);
  if (rows->layers.size() == 1 && rows->layers[0].material == &std::get<Material>(scene.material))
    return std::nullopt;
  std::vector<const ProfileField*> fields;
  rows->sources.resize(rows->layers.size());
  fields.reserve(rows->sources.size());
  ProfileField field;
  for (std::size_t l = 0; l < rows->layers.size(); ++l) {
    RowSource& source = rows->sources[l];
    source.field = make_profile_field(*rows->layers[l].material);
    place_points(source, *rows->layers[l].mapping, count, get);
    field.max_support_mm = std::max(field.max_support_mm, source.field.max_support_mm);
    field.monotone = field.monotone && source.field.monotone;
    fields.push_back(&source.field);
  }
  rows->monotone = field.monotone;
  field.knots_mm = make_common_knots(fields, has_mixtures(rows->layers, count));
  rows->knots = make_row_knots(field.knots_mm);
  for (RowSource& source : rows->sources) prepare_knots(source, field.knots_mm);
  field.width = static_cast<int>(layered_width);
  field.height = static_cast<int>((count + layered_width - 1) / layered_width);
  field.boundary = fields[0]->boundary;
  field.eta = fields[0]->eta;
  field.eval = [rows](double x, double y, float* half_log, float* support_mm) {
    thread_local EvalScratch scratch;
    const auto point = static_cast<std::size_t>(y) * layered_width + static_cast<std::size_t>(x);
    PARIAN_CHECK_LT(point, rows->count);
    eval_layers(*rows, point, scratch);
    std::copy(scratch.row.half_log.begin(), scratch.row.half_log.end(), half_log);
    std::copy(scratch.row.support_mm.begin(), scratch.row.support_mm.end(), support_mm);
  };
  return field;
}

}  // namespace parian
