#include "compress/pictures.h"

#include <algorithm>
#include <array>
#include <numeric>

#include "base/random.h"

namespace parian {
namespace {

using Order = std::array<std::size_t, max_bases_per_pixel>;

// Slots of a pixel by falling weight; ties keep their order.
Order sort_slots(const float* weights, std::size_t count) {
  Order order{};
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(count),
                   [&](std::size_t a, std::size_t b) { return weights[a] > weights[b]; });
  return order;
}

// Calls paint(image, column, row, weight, base) for each pixel in each of the K panels.
template <typename Paint>
Image paint_panels(const ProfileBlend& blend, int channels, Paint paint) {
  const auto count = static_cast<std::size_t>(blend.per_pixel);
  Image image = make_image(blend.width * blend.per_pixel, blend.height, channels);
  std::array<float, max_bases_per_pixel> weights{};
  for (int y = 0; y < blend.height; ++y)
    for (int x = 0; x < blend.width; ++x) {
      const std::size_t pixel =
          static_cast<std::size_t>(y) * static_cast<std::size_t>(blend.width) +
          static_cast<std::size_t>(x);
      get_weights(blend, pixel, weights.data());
      const Order order = sort_slots(weights.data(), count);
      for (std::size_t k = 0; k < count; ++k)
        paint(image, x + static_cast<int>(k) * blend.width, y, weights[order[k]],
              blend.index[order[k] * blend.pixels() + pixel]);
    }
  return image;
}

}  // namespace

Image make_weight_image(const ProfileBlend& blend) {
  return paint_panels(blend, 1, [](Image& image, int x, int y, float weight, std::uint16_t) {
    at(image, x, y, 0) = weight;
  });
}

Image make_index_image(const ProfileBlend& blend) {
  return paint_panels(blend, 3, [](Image& image, int x, int y, float, std::uint16_t base) {
    for (int c = 0; c < 3; ++c)
      at(image, x, y, c) = static_cast<float>(
          0.05 + 0.9 * hash_to_uniform(hash_u64(base, static_cast<std::uint64_t>(c))));
  });
}

}  // namespace parian
