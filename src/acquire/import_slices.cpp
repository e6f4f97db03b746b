#include "acquire/import_slices.h"

#include <fmt/format.h>

#include "acquire/import_path_internal.h"
#include "acquire/provenance.h"
#include "base/error.h"

namespace parian {
namespace {

constexpr int max_side = 65535;
constexpr std::size_t max_offsets = 1000000;

std::string format_shape(const std::vector<std::size_t>& shape) {
  std::string text;
  for (const std::size_t length : shape) text += fmt::format("[{}]", length);
  return text.empty() ? "[]" : text;
}

std::vector<Offset> read_offsets(const Document& node) {
  const Document::Array& elements = as_array(node);
  if (elements.empty() || elements.size() > max_offsets)
    throw_at(node, fmt::format("1 to {} offsets", max_offsets));
  std::vector<Offset> offsets;
  offsets.reserve(elements.size());
  for (const Document& element : elements) {
    const Document::Array& pair = as_array(element);
    if (pair.size() != 2) throw_at(element, "an offset [dx, dy]");
    offsets.push_back({as_int(pair[0], -max_side, max_side), as_int(pair[1], -max_side, max_side)});
  }
  return offsets;
}

std::vector<double> read_noise(const Document& document, const char* key) {
  const Document* node = find(document, key);
  if (node == nullptr) return {};
  if (std::holds_alternative<double>(node->value)) return {as_number(*node, 0, 1e9)};
  std::vector<double> values;
  for (const Document& element : as_array(*node)) values.push_back(as_number(element, 0, 1e9));
  if (values.size() != 1 && values.size() != 3) throw_at(*node, "1 or 3 numbers");
  return values;
}

// One number counts for all channels; where one of the two is absent it is 0.
void spread_noise(const Document& document, TableHeader& header) {
  header.noise_floor = read_noise(document, "noise_floor");
  header.noise_gain = read_noise(document, "noise_gain");
  if (header.noise_floor.empty() && header.noise_gain.empty()) return;
  const auto channels = static_cast<std::size_t>(header.channels);
  for (auto* values : {&header.noise_floor, &header.noise_gain}) {
    if (values->empty()) values->push_back(0);
    if (values->size() == 1) values->assign(channels, values->front());
    if (values->size() != channels)
      throw_at(get(document, values == &header.noise_floor ? "noise_floor" : "noise_gain"),
               channels == 1 ? "1 number" : "1 or 3 numbers");
  }
}

void read_files(const Document& document, SliceImport& slices) {
  const Document* files = find(document, "files");
  const Document* file = find(document, "file");
  if ((files == nullptr) == (file == nullptr))
    throw_at(document, "one of the keys 'files' and 'file'", files != nullptr ? "both" : "neither");
  slices.together = file != nullptr;
  if (slices.together) {
    slices.files = {path_beside(document, as_string(*file))};
    return;
  }
  for (const Document& element : as_array(*files))
    slices.files.push_back(path_beside(document, as_string(element)));
  if (slices.files.size() != slices.header.offsets.size())
    throw_at(*files, fmt::format("{} files, one for each offset", slices.header.offsets.size()),
             fmt::format("{}", slices.files.size()));
}

[[noreturn]] void throw_shape(const std::string& file, const std::string& expected,
                              const NamedArray& array) {
  throw Error({file, "shape", expected, format_shape(array.shape)});
}

void read_grid(const NamedArray& array, SliceImport& slices) {
  TableHeader& header = slices.header;
  const std::vector<std::size_t>& shape = array.shape;
  std::size_t channels = 1, height = 0, width = 0;
  if (slices.together) {
    const std::size_t offsets = header.offsets.size();
    const bool with_channels = shape.size() == 4;
    if ((shape.size() != 3 && !with_channels) || shape[with_channels ? 1 : 0] != offsets)
      throw_shape(slices.files[0],
                  fmt::format("[{0}][height][width] or [channels][{0}][height][width]", offsets),
                  array);
    channels = with_channels ? shape[0] : 1;
    height = shape[shape.size() - 2], width = shape.back();
  } else {
    if (shape.size() != 2 && shape.size() != 3)
      throw_shape(slices.files[0], "[height][width] or [height][width][channels]", array);
    channels = shape.size() == 3 ? shape[2] : 1;
    height = shape[0], width = shape[1];
  }
  if ((channels != 1 && channels != 3) || height > max_side || width > max_side)
    throw_shape(slices.files[0],
                fmt::format("1 or 3 channels and sides of at most {} pixels", max_side), array);
  header.channels = static_cast<int>(channels);
  header.height = static_cast<int>(height);
  header.width = static_cast<int>(width);
}

// Of the array [y][x][channel].
void copy_channel(const NamedArray& array, std::size_t channels, std::size_t channel,
                  std::vector<float>& slice) {
  for (std::size_t i = 0; i < slice.size(); ++i) slice[i] = array.values[i * channels + channel];
}

// One channel may have an axis of its own or none.
void check_shape(const SliceImport& slices, const std::string& file, const NamedArray& array) {
  const TableHeader& header = slices.header;
  std::vector<std::size_t> expected{static_cast<std::size_t>(header.height),
                                    static_cast<std::size_t>(header.width)};
  if (header.channels > 1 || (array.shape.size() == 3 && array.shape[2] == 1))
    expected.push_back(static_cast<std::size_t>(header.channels));
  if (array.shape != expected)
    throw_shape(file, fmt::format("{}, as '{}' has", format_shape(expected), slices.files[0]),
                array);
}

}  // namespace

SliceImport read_slice_import(const Document& document, const ArrayLoader& load_array) {
  check_keys(document, {"$schema", "kind", "description", "pitch_mm", "offsets", "files", "file",
                        "boundary", "eta", "symmetric", "sampling", "noise_floor", "noise_gain"});
  SliceImport slices;
  TableHeader& header = slices.header;
  header.pixel_pitch_mm = as_number(get(document, "pitch_mm"), 1e-6, 1e6);
  header.offsets = read_offsets(get(document, "offsets"));
  if (const Document* eta = find(document, "eta")) header.eta = as_number(*eta, 1, 4);
  if (const Document* both = find(document, "symmetric")) header.symmetric = as_bool(*both);
  const auto choose = [&](const char* key, const char* first, const char* second) {
    const Document* node = find(document, key);
    if (node == nullptr || as_string(*node) == first) return false;
    if (as_string(*node) != second)
      throw_at(*node, fmt::format("'{}' or '{}'", first, second),
               fmt::format("'{}'", as_string(*node)));
    return true;
  };
  if (choose("boundary", "excluded", "included")) header.boundary = Boundary::included;
  if (choose("sampling", "point", "area")) header.sampling = Sampling::area;
  read_files(document, slices);
  read_grid(load_array(slices.files[0]), slices);
  spread_noise(document, header);
  header.provenance = format_compact(
      Document::Object{{"kind", "import"}, {"simulated", false}, {"import", document}});
  check(header, document.file ? *document.file : std::string());
  return slices;
}

void import_slices(const SliceImport& slices, const ArrayLoader& load_array, SliceSink& sink,
                   const Progress& progress) {
  const TableHeader& header = slices.header;
  const auto channels = static_cast<std::size_t>(header.channels);
  const std::size_t offsets = header.offsets.size(), pixels = header.pixels();
  std::vector<float> slice(pixels);
  NamedArray array;
  if (slices.together) array = load_array(slices.files[0]);
  for (std::size_t d = 0; d < offsets; ++d) {
    advance_progress(progress, "import", static_cast<double>(d) / static_cast<double>(offsets));
    const std::string& file = slices.files[slices.together ? 0 : d];
    if (!slices.together) {
      array = load_array(file);
      check_shape(slices, file, array);
    }
    for (std::size_t c = 0; c < channels; ++c) {
      if (slices.together) {
        const float* begin = array.values.data() + (c * offsets + d) * pixels;
        slice.assign(begin, begin + pixels);
      } else {
        copy_channel(array, channels, c, slice);
      }
      clean_slice(header, file, static_cast<int>(c), static_cast<int>(d), slice.data());
      sink.write_slice(static_cast<int>(c), static_cast<int>(d), slice.data());
    }
  }
  sink.finish();
}

}  // namespace parian
