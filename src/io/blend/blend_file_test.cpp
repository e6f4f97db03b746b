#include "io/blend/blend_file.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <functional>

#include "base/random.h"
#include "base/test_errors.h"
#include "io/blend/sections_internal.h"
#include "io/json/files.h"
#include "material/test_blends.h"

namespace parian {
namespace {

std::string error_of(const std::string& bytes) {
  return parian::error_of([&] { decode_blend(bytes, "b.kbm"); });
}

void expect_equal(const ProfileBlend& a, const ProfileBlend& b) {
  EXPECT_EQ(a.width, b.width);
  EXPECT_EQ(a.height, b.height);
  EXPECT_EQ(a.channels, b.channels);
  EXPECT_EQ(a.per_pixel, b.per_pixel);
  EXPECT_EQ(a.pixel_pitch_mm, b.pixel_pitch_mm);
  EXPECT_EQ(a.boundary, b.boundary);
  EXPECT_EQ(a.eta, b.eta);
  EXPECT_EQ(a.knots_mm, b.knots_mm);
  EXPECT_EQ(a.gain, b.gain);
  EXPECT_EQ(a.dilation, b.dilation);
  EXPECT_EQ(a.grid, b.grid);
  EXPECT_EQ(a.hold_out.fraction, b.hold_out.fraction);
  EXPECT_EQ(a.hold_out.seed, b.hold_out.seed);
  EXPECT_EQ(a.provenance, b.provenance);
}

TEST(BlendFile, PaperEncodingKeepsEveryBit) {
  for (int k : {1, 2, 8})
    for (int bases : {5, 300}) {
      ProfileBlend blend = make_blend(k, bases);
      const std::string bytes = encode_blend(blend, BlendEncoding::paper);
      const ProfileBlend back = decode_blend(bytes, "b.kbm");
      expect_equal(back, blend);
      EXPECT_EQ(back.base_log_profile, blend.base_log_profile);
      EXPECT_EQ(back.index, blend.index);
      EXPECT_EQ(back.weight, blend.weight);
    }
}

// Sections hold nothing but the bytes that the format says: 12 for each section, and the header.
TEST(BlendFile, PaperEncodingHasExactlyThePapersBytes) {
  const ProfileBlend blend = make_blend(2, 128);
  const std::string path = testing::TempDir() + "paper.kbm";
  save_blend(path, blend, BlendEncoding::paper);
  const BlendBytes bytes = measure_blend_file(path);
  EXPECT_EQ(bytes.profiles, 12 * 128 * blend.knots_mm.size());
  EXPECT_EQ(bytes.indices + bytes.weights, 6 * blend.pixels());
  EXPECT_EQ(bytes.profiles + bytes.indices + bytes.weights, paper_bytes(blend));
  EXPECT_EQ(bytes.file, std::filesystem::file_size(path));
  EXPECT_TRUE(is_blend_file(path));
  std::filesystem::remove(path);
}

// Bases may be renumbered and entries sorted: the profiles stay, to the rounding of the last
// weight.
TEST(BlendFile, PackedEncodingKeepsTheMaterial) {
  for (int channels : {1, 3})
    for (int k : {1, 2, 3, 8})
      for (int bases : {1, 5, 300}) {
        ProfileBlend blend = make_blend(k, bases, channels);
        snap_to_grid(blend, {0.004, 63});
        const std::string bytes = encode_blend(blend, BlendEncoding::packed);
        const ProfileBlend back = decode_blend(bytes, "b.kbm");
        expect_equal(back, blend);
        const ProfileMap a = make_profile_map(blend), b = make_profile_map(back);
        for (std::size_t i = 0; i < a.log_profile.size(); ++i)
          ASSERT_NEAR(a.log_profile[i], b.log_profile[i], 1e-5f);
        EXPECT_TRUE(encode_blend(back, BlendEncoding::packed) == bytes);
      }
}

TEST(BlendFile, GainAndDilationAreKept) {
  ProfileBlend blend = make_blend(2, 5);
  blend.gain.assign(3 * blend.pixels(), 0.5f);
  blend.dilation.assign(3 * blend.pixels(), 1.5f);
  snap_to_grid(blend, {0.004, 63});
  for (BlendEncoding encoding : {BlendEncoding::paper, BlendEncoding::packed})
    expect_equal(decode_blend(encode_blend(blend, encoding), "b.kbm"), blend);
}

TEST(BlendFile, PackedNeedsAGrid) {
  EXPECT_EQ(parian::error_of([&] { encode_blend(make_blend(2, 5), BlendEncoding::packed); }),
            "the blend to write: grid: expected a step and levels, as packed files need, "
            "found none");
}

TEST(BlendFile, EveryTruncationIsAnError) {
  ProfileBlend blend = make_blend(2, 5);
  snap_to_grid(blend, {0.004, 63});
  for (BlendEncoding encoding : {BlendEncoding::paper, BlendEncoding::packed}) {
    const std::string bytes = encode_blend(blend, encoding);
    for (std::size_t count = 0; count < bytes.size(); ++count)
      ASSERT_NE(error_of(bytes.substr(0, count)), "no error") << count;
  }
}

TEST(BlendFile, EveryFlippedByteIsAnError) {
  const std::string good = encode_blend(make_blend(2, 5), BlendEncoding::paper);
  for (std::size_t i = 0; i < good.size(); ++i) {
    std::string bytes = good;
    bytes[i] = static_cast<char>(bytes[i] ^ 0x10);
    ASSERT_NE(error_of(bytes), "no error") << i;
  }
}

TEST(BlendFile, DamageIsNamed) {
  const std::string good = encode_blend(make_blend(2, 5), BlendEncoding::paper);
  EXPECT_EQ(error_of("KBM"), "b.kbm: magic number: expected 'KBM1', found another kind of file");
  EXPECT_EQ(error_of("PNG!" + good.substr(4)),
            "b.kbm: magic number: expected 'KBM1', found another kind of file");
  std::string bytes = good;
  bytes[4] = 2;
  EXPECT_EQ(error_of(bytes), "b.kbm: version: expected 1, found 2");
  bytes = good;
  bytes.back() = static_cast<char>(bytes.back() ^ 1);
  const std::string error = error_of(bytes);
  EXPECT_EQ(error.substr(0, 44), "b.kbm: section 'weights': expected checksum ");
  EXPECT_EQ(error.substr(error.size() - 21), ": the file is damaged");
  EXPECT_EQ(error_of(good.substr(0, good.size() - 1)),
            "b.kbm: section 'weights': expected 140 bytes, found 139 before the file's end");
  EXPECT_EQ(error_of(good + "x"), "b.kbm: end: expected no more bytes, found 1");
}

// Files with valid checksums and bad contents.
std::string with_header(const std::function<void(std::string&)>& edit) {
  const std::string good = encode_blend(make_blend(2, 5), BlendEncoding::paper);
  ByteReader reader{std::string_view(good).substr(8), "good"};
  std::string header(reader.take_section("header"));
  edit(header);
  std::string bytes = good.substr(0, 8);
  append_section(bytes, header);
  return bytes.append(reader.bytes);
}

std::string replaced(const std::string& from, const std::string& to) {
  return error_of(with_header([&](std::string& header) {
    const std::size_t at = header.find(from);
    ASSERT_NE(at, std::string::npos);
    header.replace(at, from.size(), to);
  }));
}

TEST(BlendFile, HeadersAreChecked) {
  EXPECT_EQ(replaced("\"bases\": 5", "\"bases\": 4"),
            "b.kbm: section 'profiles': expected 192 bytes, found 240");
  EXPECT_EQ(replaced("\"width\": 7", "\"width\": 0"),
            "b.kbm: /width: expected a whole number in [1, 65535], found the number 0");
  EXPECT_EQ(replaced("\"per_pixel\": 2", "\"per_pixel\": 9"),
            "b.kbm: /per_pixel: expected a whole number in [1, 8], found the number 9");
  EXPECT_EQ(replaced("\"encoding\": \"paper\"", "\"encoding\": \"zip\""),
            "b.kbm: /encoding: expected 'packed' or 'paper', found the string 'zip'");
  EXPECT_EQ(replaced("\"width\": 7,\n  \"height\": 5", "\"width\": 65535,\n  \"height\": 65535"),
            "b.kbm: /height: expected at most 67108864 pixels, found 4294836225");
}

TEST(BlendFile, HugeClaimsOfSmallFramesAreRefused) {
  ProfileBlend blend = make_blend(2, 5);
  snap_to_grid(blend, {0.004, 63});
  const std::string good = encode_blend(blend, BlendEncoding::packed);
  ByteReader reader{std::string_view(good).substr(8), "good"};
  std::string header(reader.take_section("header"));
  header.replace(header.find("\"width\": 7"), 10, "\"width\": 8000");
  header.replace(header.find("\"height\": 5"), 11, "\"height\": 8000");
  std::string bytes = good.substr(0, 8);
  append_section(bytes, header);
  bytes.append(reader.bytes);
  const std::string error = error_of(bytes);
  EXPECT_EQ(error.substr(0, 68),
            "b.kbm: section 'indices': expected a frame of 64000000 bytes, found ");
}

TEST(BlendFile, IndicesAndWeightsAreChecked) {
  const ProfileBlend blend = make_blend(2, 5);
  const std::string good = encode_blend(blend, BlendEncoding::paper);
  ByteReader reader{std::string_view(good).substr(8), "good"};
  const std::string header(reader.take_section("header"));
  const std::string profiles(reader.take_section("profiles"));
  std::string indices(reader.take_section("indices"));
  const std::string weights(reader.take_section("weights"));
  indices[3] = 5;
  std::string bytes = good.substr(0, 8);
  for (const std::string& part : {header, profiles, indices, weights}) append_section(bytes, part);
  EXPECT_EQ(error_of(bytes), "b.kbm: pixel (3, 0): expected an index below 5, found 5");
  indices[3] = 0;
  std::string heavy = weights;
  const float two = 2;
  std::memcpy(heavy.data(), &two, sizeof(two));
  bytes = good.substr(0, 8);
  for (const std::string& part : {header, profiles, indices, heavy}) append_section(bytes, part);
  EXPECT_EQ(error_of(bytes),
            "b.kbm: pixel (0, 0): expected weights that sum to at most 1, found 2");
}

}  // namespace
}  // namespace parian
