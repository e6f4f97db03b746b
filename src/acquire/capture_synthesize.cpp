#include "acquire/capture_synthesize.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "acquire/capture_photometry.h"
#include "base/check.h"
#include "base/parallel.h"
#include "base/random.h"

namespace parian {
namespace {

constexpr int supersampling = 4;  // cells per camera pixel and axis, in which the blur is done
constexpr int points = 4;         // per cell and axis, that see one pixel of the table each
constexpr int margin_px = 8;      // of the picture around the sample, camera pixels

std::size_t index_of(int x, int y, int width) {
  return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
         static_cast<std::size_t>(x);
}

// The scene as radiance times pi / E per pixel of the table, and how it becomes a picture.
class Camera {
 public:
  Camera(const CaptureMeta& meta, const PhotographParams& params, const Homography& mm_to_px)
      : meta_(meta), params_(params) {
    const Homography px_to_mm = invert(mm_to_px);
    const int width = meta.camera_width * supersampling;
    const int height = meta.camera_height * supersampling;
    begin_.push_back(0);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        for (int j = 0; j < points; ++j)
          for (int i = 0; i < points; ++i)
            look_at(parian::apply(px_to_mm, (x + (i + 0.5) / points) / supersampling,
                                  (y + (j + 0.5) / points) / supersampling));
        begin_.push_back(seen_.size());
      }
    const double sigma = params.blur_px * supersampling;
    const int reach = static_cast<int>(std::ceil(5 * sigma));
    double sum = 0;
    for (int i = -reach; i <= reach; ++i) {
      kernel_.push_back(sigma > 0 ? std::exp(-0.5 * i * i / (sigma * sigma)) : 1);
      sum += kernel_.back();
    }
    for (double& weight : kernel_) weight /= sum;
  }

  // Radiance [channel][y][x] of the table's pixels -> camera, blurred and vignetted; 0 outside.
  Image expose(const std::vector<double>& radiance) const {
    Image picture = make_image(meta_.camera_width, meta_.camera_height, meta_.channels);
    for (int c = 0; c < meta_.channels; ++c) expose_channel(radiance, c, picture);
    return picture;
  }

 private:
  // Adds the table's pixel at a place to the last cell.
  void look_at(const Point& mm) {
    const double u = std::floor(mm.x / meta_.pixel_pitch_mm);
    const double v = std::floor(mm.y / meta_.pixel_pitch_mm);
    if (u < 0 || v < 0 || u >= meta_.width || v >= meta_.height) return;
    const auto pixel =
        static_cast<std::uint32_t>(index_of(static_cast<int>(u), static_cast<int>(v), meta_.width));
    const auto same = std::find_if(seen_.begin() + static_cast<std::ptrdiff_t>(begin_.back()),
                                   seen_.end(), [&](const Seen& s) { return s.pixel == pixel; });
    if (same == seen_.end()) {
      seen_.push_back({pixel, 1});
    } else {
      same->points += 1;
    }
  }

  double radiance_of(const double* plane, std::size_t cell) const {
    double sum = 0;
    for (std::size_t k = begin_[cell]; k < begin_[cell + 1]; ++k)
      sum += seen_[k].points * plane[seen_[k].pixel];
    return sum / (points * points);
  }

  void expose_channel(const std::vector<double>& radiance, int c, Image& picture) const {
    const int width = meta_.camera_width * supersampling;
    const int height = meta_.camera_height * supersampling;
    const int reach = static_cast<int>(kernel_.size() / 2);
    const double* plane = radiance.data() + static_cast<std::size_t>(c) *
                                                static_cast<std::size_t>(meta_.width) *
                                                static_cast<std::size_t>(meta_.height);
    // Across, already in columns of whole pixels; then down.
    std::vector<double> columns(static_cast<std::size_t>(meta_.camera_width) *
                                static_cast<std::size_t>(height));
    std::vector<double> row(static_cast<std::size_t>(width));
    for (int y = 0; y < height; ++y) {
      bool any = false;
      for (int x = 0; x < width; ++x) {
        row[static_cast<std::size_t>(x)] = radiance_of(plane, index_of(x, y, width));
        any = any || row[static_cast<std::size_t>(x)] != 0;
      }
      if (!any) continue;
      for (int x = 0; x < width; ++x) {
        double sum = 0;
        for (int i = std::max(-reach, -x); i <= std::min(reach, width - 1 - x); ++i)
          sum +=
              kernel_[static_cast<std::size_t>(i + reach)] * row[static_cast<std::size_t>(x + i)];
        columns[index_of(x / supersampling, y, meta_.camera_width)] += sum / supersampling;
      }
    }
    for (int y = 0; y < height; ++y)
      for (int i = std::max(-reach, -y); i <= std::min(reach, height - 1 - y); ++i)
        for (int x = 0; x < meta_.camera_width; ++x)
          at(picture, x, y / supersampling, c) +=
              static_cast<float>(kernel_[static_cast<std::size_t>(i + reach)] / supersampling *
                                 columns[index_of(x, y + i, meta_.camera_width)]);
    for (int y = 0; y < meta_.camera_height; ++y)
      for (int x = 0; x < meta_.camera_width; ++x)
        at(picture, x, y, c) *= static_cast<float>(vignetting(x + 0.5, y + 0.5));
  }

  double vignetting(double x, double y) const {
    const double dx = 2 * x / meta_.camera_width - 1, dy = 2 * y / meta_.camera_height - 1;
    return 1 - params_.vignetting * (dx * dx + dy * dy) / 2;
  }

  const CaptureMeta& meta_;
  const PhotographParams& params_;
  // Cell k sees the table's pixels [begin_[k], begin_[k + 1]) of seen_.
  struct Seen {
    std::uint32_t pixel = 0;
    float points = 0;
  };
  std::vector<std::size_t> begin_;
  std::vector<Seen> seen_;
  std::vector<double> kernel_;
};

// E(x) relative to its largest: it falls to the lower right.
double projector(const CaptureMeta& meta, const PhotographParams& params, int x, int y) {
  const double u = (x + 0.5) / meta.width, v = (y + 0.5) / meta.height;
  return 1 - params.nonuniformity * (0.6 * u * u + 0.4 * v);
}

// pi L / E_max of the sample where the table's pixels of frame (i, j) are lit; all of them with a
// lattice of 1: the sum over pairs of E(y) R(x, y) pitch^2.
std::vector<double> light_sample(const BssrdfTable& truth, const CaptureMeta& meta,
                                 const PhotographParams& params, int i, int j, int lattice) {
  const TableHeader& header = truth.header;
  const std::size_t pixels = header.pixels();
  const double area = meta.pixel_pitch_mm * meta.pixel_pitch_mm;
  std::vector<double> radiance(pixels * static_cast<std::size_t>(meta.channels));
  const auto is_lit = [&](int x, int y) { return x % lattice == i && y % lattice == j; };
  for (int c = 0; c < meta.channels; ++c) {
    double* plane = radiance.data() + static_cast<std::size_t>(c) * pixels;
    for (std::size_t d = 0; d < header.offsets.size(); ++d) {
      const Offset offset = header.offsets[d];
      const PixelRange range = pairs_in_grid(header, offset);
      const float* slice = slice_of(truth, c, static_cast<int>(d));
      for (int y = range.y0; y < range.y1; ++y)
        for (int x = range.x0; x < range.x1; ++x) {
          const int px = x + offset.dx, py = y + offset.dy;
          const bool forth = is_lit(px, py), back = is_lit(x, y) && offset != Offset{};
          if (!forth && !back) continue;
          const double value = slice[index_of(x, y, meta.width)];
          if (std::isnan(value)) continue;
          if (forth)
            plane[index_of(x, y, meta.width)] += value * area * projector(meta, params, px, py);
          if (back)
            plane[index_of(px, py, meta.width)] += value * area * projector(meta, params, x, y);
        }
    }
    for (int y = 0; y < meta.height; ++y)
      for (int x = 0; x < meta.width; ++x)
        if (is_lit(x, y))
          plane[index_of(x, y, meta.width)] += params.specular * projector(meta, params, x, y);
  }
  return radiance;
}

std::vector<double> light_standard(const CaptureMeta& meta, const PhotographParams& params,
                                   int lattice) {
  const std::size_t pixels =
      static_cast<std::size_t>(meta.width) * static_cast<std::size_t>(meta.height);
  std::vector<double> radiance(pixels * static_cast<std::size_t>(meta.channels));
  for (int c = 0; c < meta.channels; ++c)
    for (int y = 0; y < meta.height; ++y)
      for (int x = 0; x < meta.width; ++x)
        if (x % lattice == 0 && y % lattice == 0)
          radiance[static_cast<std::size_t>(c) * pixels + index_of(x, y, meta.width)] =
              meta.reference_albedo * projector(meta, params, x, y);
  return radiance;
}

// Codes of one frame. `light` is linear, in parts of full scale per second.
Image take_frame(const CaptureMeta& meta, const PhotographParams& params, const Response& response,
                 const Image& light, const FrameName& frame, std::uint64_t stream) {
  Rng rng = make_rng(params.seed, stream);
  const double seconds = meta.exposures_s[static_cast<std::size_t>(frame.exposure)];
  Image codes = light;
  for (float& value : codes.values) {
    double linear = value * seconds;
    if (params.full_well > 0) {
      linear = sample_poisson(rng, linear * params.full_well) / params.full_well;
      linear += params.read_noise / params.full_well * sample_normal(rng);
    }
    value = static_cast<float>(
        invert_response(response, std::clamp(linear + params.dark_level, 0.0, 1.0)));
  }
  return codes;
}

// white * black_level + pattern * (1 - black_level), scaled to the camera.
Image combine(const Image& white, const Image* pattern, double black_level, double gain) {
  Image image = white;
  for (std::size_t k = 0; k < image.values.size(); ++k) {
    const double light = pattern != nullptr ? (1 - black_level) * pattern->values[k] : 0;
    image.values[k] = static_cast<float>(gain * (black_level * white.values[k] + light));
  }
  return image;
}

}  // namespace

ParamList describe(PhotographParams& params) {
  return {{.name = "scale",
           .help = "camera pixels per pixel of the table",
           .target = &params.scale,
           .min = 1,
           .max = 32},
          {.name = "rotation-deg",
           .help = "of the camera",
           .target = &params.rotation_deg,
           .min = -30,
           .max = 30},
          {.name = "perspective",
           .help = "change of scale across the picture",
           .target = &params.perspective,
           .min = -0.3,
           .max = 0.3},
          {.name = "blur-px",
           .help = "standard deviation in camera pixels",
           .target = &params.blur_px,
           .min = 0,
           .max = 10},
          {.name = "vignetting",
           .help = "loss in the picture's corners",
           .target = &params.vignetting,
           .min = 0,
           .max = 0.9},
          {.name = "nonuniformity",
           .help = "of the projector across the sample",
           .target = &params.nonuniformity,
           .min = 0,
           .max = 0.9},
          {.name = "black-level",
           .help = "of the projector, relative to white",
           .target = &params.black_level,
           .min = 0,
           .max = 0.5},
          {.name = "specular",
           .help = "part of a dot's light that is reflected where it falls",
           .target = &params.specular,
           .min = 0,
           .max = 1},
          {.name = "dark-level",
           .help = "offset of the camera's codes",
           .target = &params.dark_level,
           .min = 0,
           .max = 0.5},
          {.name = "full-well",
           .help = "electrons at code 1; 0: no noise",
           .target = &params.full_well,
           .min = 0,
           .max = 1e9},
          {.name = "read-noise",
           .help = "electrons",
           .target = &params.read_noise,
           .min = 0,
           .max = 1e6},
          {.name = "reference-level",
           .help = "of the standard under white light at the shortest exposure, of full scale",
           .target = &params.reference_level,
           .min = 0.001,
           .max = 100},
          {.name = "seed", .help = "of the noise", .target = &params.seed}};
}

Homography make_camera(const PhotographParams& params, CaptureMeta& meta) {
  const double s = params.scale / meta.pixel_pitch_mm;
  const double angle = params.rotation_deg * std::numbers::pi / 180;
  const double width = meta.width * meta.pixel_pitch_mm, height = meta.height * meta.pixel_pitch_mm;
  Homography h;
  h.m = {s * std::cos(angle),
         -s * std::sin(angle),
         0,
         s * std::sin(angle),
         s * std::cos(angle),
         0,
         params.perspective / width,
         -0.5 * params.perspective / height,
         1};
  double x0 = 1e30, x1 = -1e30, y0 = 1e30, y1 = -1e30;
  for (const double x : {0.0, width})
    for (const double y : {0.0, height}) {
      const Point p = apply(h, x, y);
      x0 = std::min(x0, p.x), x1 = std::max(x1, p.x);
      y0 = std::min(y0, p.y), y1 = std::max(y1, p.y);
    }
  // Moved by a translation on the left, with a fraction so that no pixel fits another by chance.
  const double tx = margin_px + 0.37 - x0, ty = margin_px + 0.19 - y0;
  for (std::size_t k = 0; k < 3; ++k) h.m[k] += tx * h.m[6 + k], h.m[3 + k] += ty * h.m[6 + k];
  meta.camera_width = static_cast<int>(std::ceil(x1 - x0)) + 2 * margin_px;
  meta.camera_height = static_cast<int>(std::ceil(y1 - y0)) + 2 * margin_px;
  return h;
}

void synthesize_capture(const BssrdfTable& truth, const CaptureMeta& meta,
                        const PhotographParams& params,
                        const std::function<void(const FrameName&, const Image&)>& save,
                        const Progress& progress) {
  PARIAN_CHECK_EQ(truth.header.width, meta.width);
  PARIAN_CHECK_EQ(truth.header.height, meta.height);
  PARIAN_CHECK_EQ(truth.header.channels, meta.channels);
  CaptureMeta copy = meta;
  const Camera camera(meta, params, make_camera(params, copy));
  PARIAN_CHECK_EQ(copy.camera_width, meta.camera_width);
  PARIAN_CHECK_EQ(copy.camera_height, meta.camera_height);
  const Response response = make_response(meta.response == ResponseKind::linear
                                              ? ResponseKind::linear
                                              : ResponseKind::srgb);  // what there is to recover
  const double gain = params.reference_level / (meta.reference_albedo * meta.exposures_s[0]);
  const Image white = camera.expose(light_sample(truth, meta, params, 0, 0, 1));
  const Image standard = camera.expose(light_standard(meta, params, 1));
  const Image standard_dots = camera.expose(light_standard(meta, params, meta.lattice_px));
  const auto lattice = static_cast<std::size_t>(meta.lattice_px);
  std::vector<Image> dots(lattice);  // of one row of shifts
  int row = -1;
  std::uint64_t stream = 0;
  const auto light_of = [&](const FrameName& frame) {
    const double black = params.black_level;
    switch (frame.role) {
      case FrameRole::dark:
        return make_image(meta.camera_width, meta.camera_height, meta.channels);
      case FrameRole::black:
        return combine(white, nullptr, black, gain);
      case FrameRole::white:
        return combine(white, &white, black, gain);
      case FrameRole::reference_black:
        return combine(standard, nullptr, black, gain);
      case FrameRole::reference:
        return combine(standard, &standard, black, gain);
      case FrameRole::reference_dots:
        return combine(standard, &standard_dots, black, gain);
      case FrameRole::dots:
        break;
    }
    return combine(white, &dots[static_cast<std::size_t>(frame.i)], black, gain);
  };
  for (const FrameName& frame : list_frames(meta)) {
    if (frame.role == FrameRole::dots && frame.j != row) {
      row = frame.j;
      advance_progress(progress, "frames", static_cast<double>(row) / meta.lattice_px);
      parallel_for(lattice, [&](std::size_t i) {
        dots[i] = camera.expose(
            light_sample(truth, meta, params, static_cast<int>(i), row, meta.lattice_px));
      });
    }
    save(frame, take_frame(meta, params, response, light_of(frame), frame, ++stream));
  }
}

}  // namespace parian
