#include "acquire/capture_photometry.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "acquire/positive_fit_internal.h"
#include "base/check.h"
#include "base/error.h"
#include "image/color.h"

namespace parian {
namespace {

constexpr std::size_t response_steps = 1024;
constexpr std::size_t response_terms = 13;
constexpr float infinity = std::numeric_limits<float>::infinity();

Response tabulate(const std::function<double(double)>& curve) {
  Response response;
  response.linear.resize(response_steps + 1);
  for (std::size_t i = 0; i <= response_steps; ++i)
    response.linear[i] = curve(static_cast<double>(i) / static_cast<double>(response_steps));
  return response;
}

// code, code^1.25, ... code^4
double basis(std::size_t k, double code) {
  return std::pow(code, 1 + 0.25 * static_cast<double>(k));
}

}  // namespace

Response make_response(ResponseKind kind) {
  if (kind != ResponseKind::srgb) return {};
  return tabulate([](double code) { return decode_srgb(static_cast<float>(code)); });
}

double eval_response(const Response& response, double code) {
  if (response.linear.empty()) return code;
  const double at = std::clamp(code, 0.0, 1.0) * static_cast<double>(response.linear.size() - 1);
  const auto i = std::min(static_cast<std::size_t>(at), response.linear.size() - 2);
  const double t = at - static_cast<double>(i);
  return (1 - t) * response.linear[i] + t * response.linear[i + 1];
}

double invert_response(const Response& response, double linear) {
  if (response.linear.empty()) return std::clamp(linear, 0.0, 1.0);
  const auto above =
      std::upper_bound(response.linear.begin() + 1, response.linear.end() - 1, linear);
  const double low = *(above - 1), high = *above;
  const double t = std::clamp((linear - low) / (high - low), 0.0, 1.0);
  return (static_cast<double>(above - 1 - response.linear.begin()) + t) /
         static_cast<double>(response.linear.size() - 1);
}

Response recover_response(const std::vector<ExposurePair>& pairs) {
  if (pairs.size() < 50)
    throw Error({{},
                 "response",
                 "50 pixels that are seen at two exposures or more",
                 fmt::format("{}", pairs.size())});
  std::array<Coefficients<response_terms>, response_terms> normal{};
  double trace = 0;
  for (const ExposurePair& pair : pairs) {
    // (g(a) - g(dark_a)) s_b / s_a = g(b) - g(dark_b), linear in the coefficients.
    const double ratio = pair.seconds_b / pair.seconds_a;
    Coefficients<response_terms> row{};
    for (std::size_t k = 0; k < response_terms; ++k)
      row[k] = (basis(k, pair.code_a) - basis(k, pair.dark_a)) * ratio -
               (basis(k, pair.code_b) - basis(k, pair.dark_b));
    for (std::size_t k = 0; k < response_terms; ++k) {
      trace += row[k] * row[k];
      for (std::size_t l = 0; l < response_terms; ++l) normal[k][l] += row[k] * row[l];
    }
  }
  // The smallest |A c|^2 with sum c = 1, by a penalty: its weight changes the length of c alone.
  const double weight = std::max(trace / response_terms, 1e-300);
  Coefficients<response_terms> right{};
  for (std::size_t k = 0; k < response_terms; ++k) {
    right[k] = weight;
    for (std::size_t l = 0; l < response_terms; ++l) normal[k][l] += weight;
  }
  const Coefficients<response_terms> c = solve_positive(normal, right);
  double sum = 0;
  for (const double value : c) sum += value;
  return tabulate([&](double code) {
    double g = 0;
    for (std::size_t k = 0; k < response_terms; ++k) g += c[k] / sum * basis(k, code);
    return g;
  });
}

CameraNoise estimate_camera_noise(const std::vector<Image>& dark, const std::vector<Image>& light,
                                  double saturation) {
  PARIAN_CHECK_LT(1u, dark.size());
  PARIAN_CHECK_LT(1u, light.size());
  const std::size_t count = dark[0].values.size();
  // Mean and variance over the repeats of value i.
  const auto measure = [](const std::vector<Image>& frames, std::size_t i, double& mean) {
    mean = 0;
    for (const Image& frame : frames) mean += frame.values[i];
    mean /= static_cast<double>(frames.size());
    double sum = 0;
    for (const Image& frame : frames) sum += (frame.values[i] - mean) * (frame.values[i] - mean);
    return sum / static_cast<double>(frames.size() - 1);
  };
  double read2 = 0, signal = 0, variance = 0;
  for (std::size_t i = 0; i < count; ++i) {
    double dark_mean = 0, light_mean = 0;
    const double dark_variance = measure(dark, i, dark_mean);
    const double light_variance = measure(light, i, light_mean);
    read2 += dark_variance;
    if (light_mean >= saturation || light_mean <= dark_mean) continue;
    signal += light_mean - dark_mean;
    variance += light_variance - dark_variance;
  }
  CameraNoise noise{.read = std::sqrt(read2 / static_cast<double>(count))};
  if (!(signal > 0) || !(variance > 0))
    throw Error({{},
                 "camera noise",
                 "frames that differ by the noise of their photons",
                 "frames that do not"});
  noise.full_well = signal / variance;
  return noise;
}

ExposureMean average_frames(const std::vector<Image>& frames, const Response& response,
                            double saturation) {
  PARIAN_CHECK_LT(0u, frames.size());
  const Image& first = frames[0];
  ExposureMean mean{.value = make_image(first.width, first.height, first.channels),
                    .saturated = std::vector<unsigned char>(first.values.size()),
                    .frames = static_cast<int>(frames.size())};
  for (const Image& frame : frames) {
    PARIAN_CHECK_EQ(frame.values.size(), first.values.size());
    for (std::size_t i = 0; i < first.values.size(); ++i) {
      if (frame.values[i] >= static_cast<float>(saturation)) mean.saturated[i] = 1;
      mean.value.values[i] += static_cast<float>(eval_response(response, frame.values[i]) /
                                                 static_cast<double>(frames.size()));
    }
  }
  return mean;
}

HdrImage merge_exposures(const std::vector<ExposureMean>& light,
                         const std::vector<ExposureMean>& dark, const std::vector<double>& seconds,
                         const CameraNoise& noise) {
  PARIAN_CHECK_EQ(light.size(), seconds.size());
  PARIAN_CHECK_EQ(dark.size(), seconds.size());
  const Image& first = light[0].value;
  HdrImage merged{.value = make_image(first.width, first.height, first.channels),
                  .variance = make_image(first.width, first.height, first.channels, infinity)};
  const double read2 = noise.read * noise.read;
  for (std::size_t i = 0; i < first.values.size(); ++i) {
    double sum = 0, time = 0;
    for (std::size_t e = 0; e < seconds.size(); ++e) {
      if (light[e].saturated[i] != 0) continue;
      sum += static_cast<double>(light[e].value.values[i]) - dark[e].value.values[i];
      time += seconds[e];
    }
    if (time == 0) continue;
    const double predicted = std::max(0.0, sum / time);
    double weighted = 0, weights = 0;
    for (std::size_t e = 0; e < seconds.size(); ++e) {
      if (light[e].saturated[i] != 0) continue;
      const double s = seconds[e];
      // The dark frames' own noise is read^2.
      const double variance =
          (read2 + predicted * s / noise.full_well) / light[e].frames + read2 / dark[e].frames;
      const double weight = s * s / std::max(variance, 1e-20);
      weighted +=
          weight / s * (static_cast<double>(light[e].value.values[i]) - dark[e].value.values[i]);
      weights += weight;
    }
    merged.value.values[i] = static_cast<float>(weighted / weights);
    merged.variance.values[i] = static_cast<float>(1 / weights);
  }
  return merged;
}

HdrImage subtract(const HdrImage& a, const HdrImage& b) {
  PARIAN_CHECK_EQ(a.value.values.size(), b.value.values.size());
  HdrImage result = a;
  for (std::size_t i = 0; i < a.value.values.size(); ++i) {
    result.value.values[i] -= b.value.values[i];
    result.variance.values[i] += b.variance.values[i];
  }
  return result;
}

}  // namespace parian
