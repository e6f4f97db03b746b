// The kernels of transport_kernels.h, for the instruction set of the file that includes this:
// PARIAN_KERNEL_SPACE names its namespace, load_halves(from, to) turns 8 half floats into floats.
namespace parian::PARIAN_KERNEL_SPACE {
namespace {

[[gnu::always_inline]] inline void load(const float* from, Floats& to) {
  std::memcpy(&to, from, sizeof to);
}
[[gnu::always_inline]] inline void add_to(float* to, const Floats& value) {
  Floats sum;
  std::memcpy(&sum, to, sizeof sum);
  sum += value;
  std::memcpy(to, &sum, sizeof sum);
}

}  // namespace

void add_multiple(const std::uint16_t* half, std::size_t blocks, std::size_t functions,
                  const float* coefficient, float* out) {
  for (std::size_t b = 0; b < blocks; ++b) {
    Floats red{}, green{}, blue{}, value;
    for (std::size_t j = 0; j < functions; ++j, half += 3 * kernel_lanes) {
      const float* c = coefficient + 3 * j;
      load_halves(half, value);
      red += c[0] * value;
      load_halves(half + kernel_lanes, value);
      green += c[1] * value;
      load_halves(half + 2 * kernel_lanes, value);
      blue += c[2] * value;
    }
    add_to(out + 3 * kernel_lanes * b, red);
    add_to(out + 3 * kernel_lanes * b + kernel_lanes, green);
    add_to(out + 3 * kernel_lanes * b + 2 * kernel_lanes, blue);
  }
}

void add_single(const std::uint16_t* half, std::size_t blocks, std::size_t functions,
                const float* coefficient, const float* three_g, const float* view, float* out) {
  for (std::size_t b = 0; b < blocks; ++b, view += 4 * kernel_lanes) {
    Floats sum[12]{}, value;
    for (std::size_t j = 0; j < functions; ++j, half += 12 * kernel_lanes) {
      const float* c = coefficient + 3 * j;
#pragma GCC unroll 12
      for (std::size_t k = 0; k < 12; ++k) {
        load_halves(half + k * kernel_lanes, value);
        sum[k] += c[k % 3] * value;
      }
    }
    Floats x, y, z;
    load(view + kernel_lanes, x);
    load(view + 2 * kernel_lanes, y);
    load(view + 3 * kernel_lanes, z);
#pragma GCC unroll 3
    for (std::size_t c = 0; c < 3; ++c) {
      const Floats along = x * sum[3 + c] + y * sum[6 + c] + z * sum[9 + c];
      const Floats scattered = sum[c] - three_g[c] * along;
      add_to(out + 3 * kernel_lanes * b + c * kernel_lanes, scattered);
    }
  }
}

void finish_radiance(const float* out, const float* view, std::size_t blocks, float* radiance) {
  for (std::size_t b = 0; b < blocks; ++b, out += 3 * kernel_lanes, view += 4 * kernel_lanes)
    for (std::size_t i = 0; i < kernel_lanes; ++i)
      for (std::size_t c = 0; c < 3; ++c)
        radiance[3 * (kernel_lanes * b + i) + c] = view[i] * out[c * kernel_lanes + i];
}

}  // namespace parian::PARIAN_KERNEL_SPACE
