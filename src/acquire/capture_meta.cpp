#include "acquire/capture_meta.h"

#include <fmt/format.h>

#include "base/error.h"

namespace parian {
namespace {

constexpr int max_side = 8192;
constexpr std::size_t max_exposures = 16;
constexpr std::size_t max_points = 4096;

const std::vector<std::string>& role_names() {
  static const std::vector<std::string> names{
      "dark", "black", "white", "reference_black", "reference", "reference_dots", "dots"};
  return names;
}

void read_size(const Document& node, int max, int& width, int& height) {
  const Document::Array& pair = as_array(node);
  if (pair.size() != 2) throw_at(node, "a size [width, height]");
  width = as_int(pair[0], 1, max);
  height = as_int(pair[1], 1, max);
}

void read_points(const Document& node, CaptureMeta& meta) {
  const Document::Array& elements = as_array(node);
  if (elements.size() < 4 || elements.size() > max_points)
    throw_at(node, fmt::format("4 to {} points", max_points));
  for (const Document& element : elements) {
    const std::vector<double> values = as_numbers(element);
    if (values.size() != 4) throw_at(element, "a point [x_mm, y_mm, x_px, y_px]");
    meta.points.push_back({values[0], values[1], values[2], values[3]});
  }
}

void check_exposures(const Document& node, const CaptureMeta& meta) {
  if (meta.exposures_s.empty() || meta.exposures_s.size() > max_exposures)
    throw_at(node, fmt::format("1 to {} exposures", max_exposures));
  for (std::size_t e = 0; e < meta.exposures_s.size(); ++e)
    if (!(meta.exposures_s[e] > (e == 0 ? 0 : meta.exposures_s[e - 1])))
      throw_at(as_array(node)[e], "exposures that increase from above 0",
               fmt::format("{}", meta.exposures_s[e]));
}

}  // namespace

ParamList describe(CaptureMeta& meta) {
  return {
      {.name = "pitch-mm",
       .help = "side of a pixel of the table",
       .target = &meta.pixel_pitch_mm,
       .min = 1e-4,
       .max = 100},
      {.name = "lattice-px",
       .help = "distance of dots in pixels of the table",
       .target = &meta.lattice_px,
       .min = 2,
       .max = 1024},
      {.name = "radius-px",
       .help = "of the table's offsets",
       .target = &meta.radius_px,
       .min = 1,
       .max = 512},
      {.name = "channels", .help = "1 or 3", .target = &meta.channels, .min = 1, .max = 3},
      {.name = "calibration-frames",
       .help = "of each exposure and role but dots",
       .target = &meta.calibration_frames,
       .min = 1,
       .max = 256},
      {.name = "format",
       .help = "of the frames",
       .target = make_choice(meta.format, {"png8", "png16", "exr"})},
      {.name = "response",
       .help = "of the camera",
       .target = make_choice(meta.response, {"linear", "srgb", "recover"})},
      {.name = "saturation",
       .help = "codes from here on are not used",
       .target = &meta.saturation,
       .min = 0.1,
       .max = 1},
      {.name = "reference-albedo",
       .help = "of the diffuse standard",
       .target = &meta.reference_albedo,
       .min = 0.01,
       .max = 1},
      {.name = "full-well",
       .help = "electrons at code 1; 0: found",
       .target = &meta.full_well,
       .min = 0,
       .max = 1e9},
      {.name = "read-noise", .help = "electrons", .target = &meta.read_noise, .min = 0, .max = 1e6},
      {.name = "psf-px",
       .help = "standard deviation of the blur; 0: found",
       .target = &meta.psf_px,
       .min = 0,
       .max = 20},
      {.name = "centre-px",
       .help = "R nearer than this is extrapolated",
       .target = &meta.centre_px,
       .min = 0,
       .max = 16},
      {.name = "eta", .help = "refractive index", .target = &meta.eta, .min = 1, .max = 4}};
}

CaptureMeta read_capture_meta(const Document& document) {
  CaptureMeta meta;
  read_params(
      document, describe(meta),
      {"$schema", "description", "size", "camera_size", "exposures_s", "points", "synthetic"});
  for (const char* key : {"pitch_mm", "lattice_px", "radius_px"}) get(document, key);
  if (meta.channels == 2) throw_at(get(document, "channels"), "1 or 3", "2");
  read_size(get(document, "size"), max_side, meta.width, meta.height);
  read_size(get(document, "camera_size"), 32768, meta.camera_width, meta.camera_height);
  meta.exposures_s = as_numbers(get(document, "exposures_s"));
  check_exposures(get(document, "exposures_s"), meta);
  if (const Document* points = find(document, "points")) read_points(*points, meta);
  if (const Document* synthetic = find(document, "synthetic")) meta.synthetic = as_bool(*synthetic);
  const int smaller = meta.width < meta.height ? meta.width : meta.height;
  if (meta.lattice_px >= smaller)  // two dots along each axis, at least
    throw_at(get(document, "lattice_px"),
             fmt::format("less than the {} pixels of the shorter side", smaller),
             fmt::format("{}", meta.lattice_px));
  if (2 * meta.radius_px > meta.lattice_px - 1)
    throw_at(get(document, "radius_px"),
             fmt::format("at most {}, so that a pixel has one dot within it",
                         (meta.lattice_px - 1) / 2.0),
             fmt::format("{}", meta.radius_px));
  if (meta.full_well == 0 && meta.calibration_frames < 2)
    throw_at(document, "two 'calibration_frames' or more, as there is no 'full_well'",
             fmt::format("{}", meta.calibration_frames));
  return meta;
}

Document write_capture_meta(const CaptureMeta& meta) {
  CaptureMeta copy = meta;
  Document document = write_params(describe(copy));
  set(document, "size", Document::Array{meta.width, meta.height});
  set(document, "camera_size", Document::Array{meta.camera_width, meta.camera_height});
  Document::Array exposures, points;
  for (const double exposure : meta.exposures_s) exposures.emplace_back(exposure);
  set(document, "exposures_s", std::move(exposures));
  for (const PointPair& point : meta.points)
    points.emplace_back(Document::Array{point.x_mm, point.y_mm, point.x_px, point.y_px});
  if (!points.empty()) set(document, "points", std::move(points));
  if (meta.synthetic) set(document, "synthetic", true);
  return document;
}

std::string frame_file(const CaptureMeta& meta, const FrameName& frame) {
  const std::string& role = role_names()[static_cast<std::size_t>(frame.role)];
  const char* extension = meta.format == FrameFormat::exr ? "exr" : "png";
  if (frame.role == FrameRole::dots)
    return fmt::format("{}_{:03}_{:03}_{}.{}", role, frame.i, frame.j, frame.exposure, extension);
  return fmt::format("{}_{}_{}.{}", role, frame.exposure, frame.repeat, extension);
}

std::vector<FrameName> list_frames(const CaptureMeta& meta) {
  const int exposures = static_cast<int>(meta.exposures_s.size());
  std::vector<FrameName> frames;
  for (std::size_t role = 0; role + 1 < role_names().size(); ++role)
    for (int e = 0; e < exposures; ++e)
      for (int k = 0; k < meta.calibration_frames; ++k)
        frames.push_back(
            {.role = static_cast<FrameRole>(role), .i = 0, .j = 0, .exposure = e, .repeat = k});
  for (int j = 0; j < meta.lattice_px; ++j)
    for (int i = 0; i < meta.lattice_px; ++i)
      for (int e = 0; e < exposures; ++e)
        frames.push_back({.role = FrameRole::dots, .i = i, .j = j, .exposure = e});
  return frames;
}

int dots_along(int size, int shift, int lattice_px) {
  return shift >= size ? 0 : (size - 1 - shift) / lattice_px + 1;
}

}  // namespace parian
