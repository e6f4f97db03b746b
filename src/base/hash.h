// Fingerprints of content: which mesh or lights a file was made for. Not against intent.
#pragma once

#include <cstdint>
#include <cstring>
#include <type_traits>
#include <vector>

#include "base/random.h"

namespace parian {

// The same on every machine of the same byte order. Chain by passing the last one as `seed`.
inline std::uint64_t hash_bytes(const void* data, std::size_t bytes, std::uint64_t seed = 0) {
  const auto* at = static_cast<const unsigned char*>(data);
  std::uint64_t hash = hash_u64(seed, bytes);
  for (; bytes > 0;) {
    std::uint64_t word = 0;
    const std::size_t step = bytes < sizeof word ? bytes : sizeof word;
    std::memcpy(&word, at, step);
    hash = hash_u64(hash, word);
    at += step;
    bytes -= step;
  }
  return hash;
}
template <typename T>
std::uint64_t hash_values(const std::vector<T>& values, std::uint64_t seed = 0) {
  static_assert(std::is_trivially_copyable_v<T>);  // and without padding
  return hash_bytes(values.data(), values.size() * sizeof(T), seed);
}
template <typename T>
std::uint64_t hash_value(const T& value, std::uint64_t seed = 0) {
  static_assert(std::is_arithmetic_v<T>);
  return hash_bytes(&value, sizeof value, seed);
}

}  // namespace parian
