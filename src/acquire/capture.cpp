#include "acquire/capture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "acquire/capture_resample.h"
#include "base/error.h"
#include "base/parallel.h"
#include "judge/asymmetry.h"

namespace parian {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();

// What all frames share.
struct Calibration {
  Response response;
  std::vector<ExposureMean> dark;  // per exposure
  CameraNoise noise;
};

struct Stage {
  const CaptureMeta& meta;
  const FrameLoader& load_frame;
};

std::vector<Image> load_repeats(const Stage& stage, FrameRole role, int exposure) {
  std::vector<Image> frames;
  frames.reserve(static_cast<std::size_t>(stage.meta.calibration_frames));
  for (int k = 0; k < stage.meta.calibration_frames; ++k)
    frames.push_back(
        stage.load_frame({.role = role, .i = 0, .j = 0, .exposure = exposure, .repeat = k}));
  return frames;
}

void linearise(const Response& response, std::vector<Image>& frames) {
  for (Image& frame : frames)
    for (float& value : frame.values) value = static_cast<float>(eval_response(response, value));
}

// Neighbouring exposures of the frames with the widest range of light.
Response find_response(const Stage& stage) {
  const CaptureMeta& meta = stage.meta;
  if (meta.response != ResponseKind::recover) return make_response(meta.response);
  std::vector<ExposurePair> pairs;
  const std::vector<FrameRole> roles{FrameRole::white, FrameRole::reference,
                                     FrameRole::reference_dots, FrameRole::dots};
  for (std::size_t e = 0; e + 1 < meta.exposures_s.size(); ++e) {
    const int exposure = static_cast<int>(e);
    const auto mean_of = [&](FrameRole role, int at) {
      return role == FrameRole::dots ? stage.load_frame({.role = role, .exposure = at})
                                     : average_frames(load_repeats(stage, role, at), {}, 1).value;
    };
    const Image dark_a = mean_of(FrameRole::dark, exposure);
    const Image dark_b = mean_of(FrameRole::dark, exposure + 1);
    for (const FrameRole role : roles) {
      const Image a = mean_of(role, exposure), b = mean_of(role, exposure + 1);
      for (std::size_t i = 0; i < a.values.size(); ++i)
        if (b.values[i] < static_cast<float>(meta.saturation) &&
            a.values[i] > dark_a.values[i] + 0.01f)
          pairs.push_back({a.values[i], dark_a.values[i], meta.exposures_s[e], b.values[i],
                           dark_b.values[i], meta.exposures_s[e + 1]});
    }
  }
  return recover_response(pairs);
}

Calibration calibrate(const Stage& stage) {
  const CaptureMeta& meta = stage.meta;
  Calibration calibration{.response = find_response(stage)};
  for (std::size_t e = 0; e < meta.exposures_s.size(); ++e)
    calibration.dark.push_back(
        average_frames(load_repeats(stage, FrameRole::dark, static_cast<int>(e)),
                       calibration.response, meta.saturation));
  if (meta.full_well > 0) {
    calibration.noise = {meta.read_noise / meta.full_well, meta.full_well};
    return calibration;
  }
  std::vector<Image> dark = load_repeats(stage, FrameRole::dark, 0);
  std::vector<Image> light = load_repeats(stage, FrameRole::reference, 0);
  linearise(calibration.response, dark);
  linearise(calibration.response, light);
  calibration.noise =
      estimate_camera_noise(dark, light, eval_response(calibration.response, meta.saturation));
  return calibration;
}

// Dots whose centroids are sought must be whole, half of a calibration frame may be saturated, and
// of a dot frame something must be left.
void check_saturation(const CaptureMeta& meta, const FrameName& frame,
                      const std::vector<float>& variance) {
  const auto count =
      static_cast<std::size_t>(std::count(variance.begin(), variance.end(), infinity));
  const std::size_t limit = frame.role == FrameRole::reference_dots ? 0
                            : frame.role == FrameRole::dots         ? variance.size() - 1
                                                                    : variance.size() / 2;
  if (count <= limit) return;
  throw Error({{},
               frame_file(meta, frame),
               fmt::format("pixels that are not saturated at {} s", meta.exposures_s[0]),
               count == variance.size()
                   ? std::string("every pixel saturated")
                   : fmt::format("{} of {} values saturated", count, variance.size())});
}

HdrImage merge(const Stage& stage, const Calibration& calibration, FrameRole role, int i, int j) {
  const CaptureMeta& meta = stage.meta;
  std::vector<ExposureMean> light;
  for (std::size_t e = 0; e < meta.exposures_s.size(); ++e) {
    const int exposure = static_cast<int>(e);
    const std::vector<Image> frames =
        role == FrameRole::dots ? std::vector<Image>{stage.load_frame({role, i, j, exposure, 0})}
                                : load_repeats(stage, role, exposure);
    light.push_back(average_frames(frames, calibration.response, meta.saturation));
  }
  HdrImage merged = merge_exposures(light, calibration.dark, meta.exposures_s, calibration.noise);
  check_saturation(meta, {.role = role, .i = i, .j = j}, merged.variance.values);
  return merged;
}

Image mean_of_channels(const HdrImage& image) {
  const auto channels = static_cast<std::size_t>(image.value.channels);
  Image mean = make_image(image.value.width, image.value.height, 1);
  for (std::size_t i = 0; i < image.value.values.size(); ++i)
    mean.values[i / channels] += image.value.values[i] / static_cast<float>(channels);
  return mean;
}

// Centroids of dots are not where the lattice's points are seen: perspective, vignetting and the
// window that they are measured in move them. The same measurement of the predicted image says by
// how much.
std::vector<PointPair> correct_points(const CaptureMeta& meta, const std::vector<PointPair>& points,
                                      const CaptureReport& found, const Image& white) {
  const std::vector<Dot> dots = find_dots(predict_dots(meta, found.mm_to_px, found.psf_px, white));
  std::vector<PointPair> predicted = match_lattice(dots, meta);
  // Both are in the order of the lattice.
  std::vector<PointPair> corrected = points;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Point true_place = apply(found.mm_to_px, points[k].x_mm, points[k].y_mm);
    corrected[k].x_px += true_place.x - predicted[k].x_px;
    corrected[k].y_px += true_place.y - predicted[k].y_px;
  }
  return corrected;
}

// Homography and blur, from the dots on the standard.
void locate(const CaptureMeta& meta, const Image& dots_on_standard, const Image& white,
            CaptureReport& report) {
  std::vector<PointPair> measured = meta.points;
  if (measured.empty()) {
    const std::vector<Dot> dots = find_dots(dots_on_standard);
    report.dots_found = static_cast<int>(dots.size());
    double sum = 0, squares = 0;
    for (const Dot& dot : dots) sum += dot.power, squares += dot.power * dot.power;
    const auto count = static_cast<double>(dots.size());
    report.dot_power_spread = std::sqrt(std::max(0.0, count * squares / (sum * sum) - 1));
    measured = match_lattice(dots, meta);
  }
  std::vector<PointPair> points = measured;
  for (int round = 0; round < 3; ++round) {
    report.mm_to_px = fit_homography(points);
    report.reprojection_px = reprojection_error(report.mm_to_px, points);
    report.psf_px = meta.psf_px > 0 ? meta.psf_px
                                    : estimate_psf(meta, report.mm_to_px, dots_on_standard, white);
    if (!meta.points.empty()) return;
    points = correct_points(meta, measured, report, white);
  }
}

// [channel][y][x]
std::vector<float> resample_all(const CameraOperator& b, const HdrImage& image) {
  std::vector<float> values;
  for (int c = 0; c < image.value.channels; ++c) {
    const std::vector<float> plane = resample(b, image, c);
    values.insert(values.end(), plane.begin(), plane.end());
  }
  return values;
}

DotResponses resample_dots(const Stage& stage, const Calibration& calibration,
                           const CameraOperator& b, const HdrImage& black, const Progress& progress,
                           CaptureReport& report) {
  const CaptureMeta& meta = stage.meta;
  const auto lattice = static_cast<std::size_t>(meta.lattice_px);
  const std::size_t frame_values = static_cast<std::size_t>(meta.channels) *
                                   static_cast<std::size_t>(meta.width) *
                                   static_cast<std::size_t>(meta.height);
  DotResponses responses{std::vector<float>(lattice * lattice * frame_values)};
  std::vector<double> saturated(lattice * lattice);
  for (std::size_t j = 0; j < lattice; ++j) {
    advance_progress(progress, "dots", static_cast<double>(j) / static_cast<double>(lattice));
    parallel_for(lattice, [&](std::size_t i) {
      const HdrImage image = subtract(
          merge(stage, calibration, FrameRole::dots, static_cast<int>(i), static_cast<int>(j)),
          black);
      const auto& variance = image.variance.values;
      saturated[j * lattice + i] =
          static_cast<double>(std::count(variance.begin(), variance.end(), infinity)) /
          static_cast<double>(variance.size());
      const std::vector<float> values = resample_all(b, image);
      std::copy(
          values.begin(), values.end(),
          responses.value.begin() + static_cast<std::ptrdiff_t>((j * lattice + i) * frame_values));
    });
  }
  for (const double part : saturated)
    report.saturated_fraction += part / static_cast<double>(saturated.size());
  return responses;
}

// |sum of frames - white| / |white| over the grid.
double check_sum(const DotResponses& responses, const std::vector<float>& white) {
  double difference2 = 0, white2 = 0;
  for (std::size_t k = 0; k < white.size(); ++k) {
    double sum = 0;
    for (std::size_t frame = k; frame < responses.value.size(); frame += white.size())
      sum += responses.value[frame];
    if (std::isnan(sum + white[k])) continue;
    difference2 += (sum - white[k]) * (sum - white[k]);
    white2 += static_cast<double>(white[k]) * white[k];
  }
  return white2 > 0 ? std::sqrt(difference2 / white2) : 1;
}

// The mean of both directions of the raw table, and the noise of either.
void finish_tables(CaptureResult& result, const Progress& progress) {
  TableHeader& header = result.raw.header;
  for (int c = 0; c < header.channels; ++c) {
    result.report.noise.push_back(fit_noise_model(result.raw, c));
    header.noise_floor[static_cast<std::size_t>(c)] = result.report.noise.back().floor;
    header.noise_gain[static_cast<std::size_t>(c)] = result.report.noise.back().gain;
  }
  result.report.asymmetry = measure_asymmetry(*make_slices(result.raw), progress);
  result.table = symmetrise(result.raw);
  // A single direction has twice the variance of the mean.
  for (double& value : header.noise_floor) value *= std::sqrt(2.0);
  for (double& value : header.noise_gain) value *= 2;
}

}  // namespace

CaptureResult process_capture(const CaptureMeta& meta, const FrameLoader& load_frame,
                              const Progress& progress) {
  const Stage stage{meta, load_frame};
  CaptureResult result;
  CaptureReport& report = result.report;
  advance_progress(progress, "calibration", 0);
  const Calibration calibration = calibrate(stage);
  report.camera = calibration.noise;
  const HdrImage reference_black = merge(stage, calibration, FrameRole::reference_black, 0, 0);
  const HdrImage reference =
      subtract(merge(stage, calibration, FrameRole::reference, 0, 0), reference_black);
  const HdrImage standard_dots =
      subtract(merge(stage, calibration, FrameRole::reference_dots, 0, 0), reference_black);
  locate(meta, mean_of_channels(standard_dots), mean_of_channels(reference), report);
  const CameraOperator b = make_camera_operator(meta, report.mm_to_px, report.psf_px);
  const HdrImage black = merge(stage, calibration, FrameRole::black, 0, 0);
  const HdrImage white = subtract(merge(stage, calibration, FrameRole::white, 0, 0), black);
  DotResponses responses = resample_dots(stage, calibration, b, black, progress, report);
  report.white_error = check_sum(responses, resample_all(b, white));
  normalise_responses(meta, resample_all(b, reference), responses);
  advance_progress(progress, "tails", 0);
  report.tail_fraction = remove_tails(meta, responses);
  result.raw = make_raw_table(meta, responses);
  report.centre_offsets = replace_centre(meta, result.raw);
  finish_tables(result, progress);
  return result;
}

Document to_document(const CaptureReport& report) {
  Document::Array homography, noise;
  for (const double value : report.mm_to_px.m) homography.emplace_back(value);
  for (const NoiseModel& model : report.noise)
    noise.emplace_back(Document::Object{
        {"floor", model.floor}, {"gain", model.gain}, {"relative", model.relative}});
  return Document::Object{{"read_noise", report.camera.read * report.camera.full_well},
                          {"full_well", report.camera.full_well},
                          {"homography", std::move(homography)},
                          {"dots_found", report.dots_found},
                          {"reprojection_px", report.reprojection_px},
                          {"psf_px", report.psf_px},
                          {"dot_power_spread", report.dot_power_spread},
                          {"saturated_fraction", report.saturated_fraction},
                          {"tail_fraction", report.tail_fraction},
                          {"centre_offsets", report.centre_offsets},
                          {"asymmetry", report.asymmetry},
                          {"white_error", report.white_error},
                          {"noise", std::move(noise)}};
}

}  // namespace parian
