#include "edit/edit_state.h"

#include <algorithm>
#include <atomic>

#include "base/check.h"
#include "base/parallel.h"

namespace parian {
namespace {

constexpr std::size_t block = 4096;

std::shared_ptr<const Plane> widen(const std::vector<float>& values, std::size_t count) {
  if (values.empty()) return std::make_shared<Plane>(count, 1.0);
  return std::make_shared<Plane>(values.begin(), values.end());
}

std::vector<float> narrow(const Plane& values) {
  if (std::all_of(values.begin(), values.end(), [](double v) { return v == 1; })) return {};
  return {values.begin(), values.end()};
}

Plane multiply(const Plane& a, const Plane& b) {
  Plane product(a.size());
  parallel_for_blocks(a.size(), block, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) product[i] = a[i] * b[i];
  });
  return product;
}

// factors * after / before where they differ, with `after` at least `least`; counts what is below.
std::shared_ptr<const Plane> rescale(const Plane& factors, const Plane& before, const Plane& after,
                                     double least, std::size_t& clamped) {
  PARIAN_CHECK_EQ(factors.size(), before.size());
  PARIAN_CHECK_EQ(factors.size(), after.size());
  auto scaled = std::make_shared<Plane>(factors.size());
  std::atomic<std::size_t> below{0};
  parallel_for_blocks(factors.size(), block, [&](std::size_t begin, std::size_t end) {
    std::size_t count = 0;
    for (std::size_t i = begin; i < end; ++i) {
      const bool changes = after[i] != before[i];
      const bool is_below = changes && !(after[i] >= least);
      count += is_below ? 1 : 0;
      (*scaled)[i] =
          changes ? factors[i] * ((is_below ? least : after[i]) / before[i]) : factors[i];
    }
    below += count;
  });
  clamped += below;
  return scaled;
}

template <typename Get>
void for_each_profile(const EditState& state, const Get& get) {
  const auto width = static_cast<std::size_t>(state.width);
  parallel_for_blocks(state.values(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const std::size_t pixel = i % state.pixels();
      get(i, get_profile(state, static_cast<int>(i / state.pixels()),
                         static_cast<int>(pixel % width), static_cast<int>(pixel / width)));
    }
  });
}

}  // namespace

EditState make_edit_state(const ProfileMap& map) {
  EditState state;
  state.width = map.width;
  state.height = map.height;
  state.channels = map.channels;
  state.pixel_pitch_mm = map.pixel_pitch_mm;
  state.boundary = map.boundary;
  state.eta = map.eta;
  state.knots_mm = map.knots_mm;
  state.gain = widen(map.gain, state.values());
  state.dilation = widen(map.dilation, state.values());
  state.shapes = make_shape_planes({map.log_profile.begin(), map.log_profile.end()}, state.knots_mm,
                                   state.pixels(), state.channels);
  return state;
}

ProfileMap make_profile_map(const EditState& state) {
  ProfileMap map;
  map.width = state.width;
  map.height = state.height;
  map.channels = state.channels;
  map.pixel_pitch_mm = state.pixel_pitch_mm;
  map.boundary = state.boundary;
  map.eta = state.eta;
  map.knots_mm = state.knots_mm;
  map.log_profile.assign(state.shapes->log_profile.begin(), state.shapes->log_profile.end());
  map.gain = narrow(*state.gain);
  map.dilation = narrow(*state.dilation);
  return map;
}

Plane albedo_plane(const EditState& state) {
  return multiply(state.shapes->albedo, *state.gain);
}

Plane range_plane(const EditState& state) {
  return multiply(state.shapes->range_mm, *state.dilation);
}

Plane mean_radius_plane(const EditState& state) {
  Plane radius(state.values());
  for_each_profile(state, [&](std::size_t i, const Profile& profile) {
    radius[i] = measure_properties(profile).mean_radius_mm;
  });
  return radius;
}

Profile get_profile(const EditState& state, int channel, int x, int y) {
  PARIAN_CHECK(x >= 0 && x < state.width && y >= 0 && y < state.height && channel >= 0 &&
               channel < state.channels);
  const std::size_t pixel = static_cast<std::size_t>(y) * static_cast<std::size_t>(state.width) +
                            static_cast<std::size_t>(x);
  const std::size_t at = static_cast<std::size_t>(channel) * state.pixels() + pixel;
  const std::size_t knots = state.knots_mm.size();
  std::vector<double> log_value;
  log_value.reserve(knots);
  for (std::size_t k = 0; k < knots; ++k) {
    const std::size_t plane = static_cast<std::size_t>(channel) * knots + k;
    log_value.push_back(
        static_cast<double>(state.shapes->log_profile[plane * state.pixels() + pixel]));
  }
  return make_profile(state.knots_mm, std::move(log_value), (*state.gain)[at],
                      (*state.dilation)[at]);
}

void set_albedo(EditState& state, const Plane& before, const Plane& after, EditReport& report) {
  state.gain = rescale(*state.gain, before, after, least_albedo, report.clamped_albedo);
}

void set_range(EditState& state, const Plane& before, const Plane& after, EditReport& report) {
  state.dilation =
      rescale(*state.dilation, before, after, least_range_mm(state), report.clamped_range);
}

void set_properties(EditState& state, const Plane& albedo, const Plane& range_mm) {
  PARIAN_CHECK_EQ(albedo.size(), state.values());
  PARIAN_CHECK_EQ(range_mm.size(), state.values());
  auto gain = std::make_shared<Plane>(state.values());
  auto dilation = std::make_shared<Plane>(state.values());
  for (std::size_t i = 0; i < state.values(); ++i) {
    (*gain)[i] = albedo[i] / state.shapes->albedo[i];
    (*dilation)[i] = range_mm[i] / state.shapes->range_mm[i];
  }
  state.gain = std::move(gain);
  state.dilation = std::move(dilation);
}

}  // namespace parian
