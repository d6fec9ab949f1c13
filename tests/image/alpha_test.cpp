// Colours of images with alpha are those of the file, whatever alpha is.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>

#include "libatlas/image/image_io.h"
#include "libatlas/image/webp_alpha.h"
#include "tests/support/file_bytes.h"
#include "tests/support/leaks.h"
#include "tests/support/temp_folder.h"

namespace atlas {
namespace {

using test::little;
using test::TempFolder;

constexpr int kSide = 4;

// The image that all files of this test hold: a colour for each row, an alpha for each column.
Image8 expected() {
  constexpr std::uint8_t kAlphas[kSide] = {0, 1, 60, 255};
  Image8 image(kSide, kSide, 4);
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      const int row = kSide - 1 - y;  // of the file
      const std::uint8_t texel[4] = {std::uint8_t(200 - 10 * row), std::uint8_t(100 - 10 * row),
                                     std::uint8_t(50 - 10 * row), kAlphas[x]};
      std::copy_n(texel, 4, image.at(x, y));
    }
  return image;
}

// Returns the texels from the upper left, with these channels.
std::string rows(const char* channels) {
  const Image8 image = expected();
  std::string bytes;
  for (int y = kSide - 1; y >= 0; --y)
    for (int x = 0; x < kSide; ++x)
      for (const char* c = channels; *c; ++c)
        bytes += char(image.at(x, y)[std::string_view("rgba").find(*c)]);
  return bytes;
}

std::string tga() {
  const std::string header = std::string("\0\0\2", 3) + std::string(9, '\0');
  return header + little(kSide, 2) + little(kSide, 2) + "\x20\x28" + rows("bgra");
}

constexpr int kAssociated = 1, kUnassociated = 2;  // what a TIFF says of its alpha

std::string tiff(int alpha = kUnassociated, const std::string& texels = rows("rgba")) {
  constexpr int kEntries = 10;
  const std::uint32_t data = 8 + 2 + 12 * kEntries + 4;
  const auto entry = [](int tag, int type, int count, std::uint32_t value) {
    return little(std::uint32_t(tag), 2) + little(std::uint32_t(type), 2) +
           little(std::uint32_t(count), 4) + little(value, 4);
  };
  constexpr int kShort = 3, kLong = 4;
  return "II*" + std::string(1, '\0') + little(8, 4) + little(kEntries, 2) +
         entry(256, kLong, 1, kSide) + entry(257, kLong, 1, kSide) +
         entry(258, kShort, 4, data) +  // bits of the channels
         entry(259, kShort, 1, 1) + entry(262, kShort, 1, 2) + entry(273, kLong, 1, data + 8) +
         entry(277, kShort, 1, 4) + entry(278, kLong, 1, kSide) +
         entry(279, kLong, 1, 4 * kSide * kSide) + entry(338, kShort, 1, std::uint32_t(alpha)) +
         little(0, 4) + little(8, 2) + little(8, 2) + little(8, 2) + little(8, 2) + texels;
}

std::string bytes_of(std::string_view hex) {
  std::string bytes;
  for (std::size_t i = 0; i + 1 < hex.size(); i += 2)
    bytes += char(std::stoi(std::string(hex.substr(i, 2)), nullptr, 16));
  return bytes;
}

// Written by libwebp: lossless, lossy, and two lossless frames.
constexpr std::string_view kLossless =
    "5249464650000000574542505650384c430000002f03c000107f20164cf1eec0120b26bbf3a78852489062b2"
    "590369db74bac6e5cfd61b3f081e57814158812068050621080220163c7852e2428929254222fa1f7b238300";
constexpr std::string_view kLossy =
    "524946467600000057454250565038580a00000010000000030000030000414c5048110000000000013cff00"
    "013cff00013cff00013cff00565038203e000000b002009d012a0400040000000025a00274ba01f801fa01fc"
    "000665588cc000fefe8c0fffa03b180a8fff241ebc9e7e7fe4847ffd9f0f393f4a7ff6990000";
constexpr std::string_view kAnimated =
    "52494646f000000057454250565038580a00000012000000030000030000414e494d06000000ffffffff0000"
    "414e4d465c000000000000000000030000030000640000025650384c430000002f03c000107f20164cf1eec0"
    "120b26bbf3a78852489062b2590369db74bac6e5cfd61b3f081e57814158812068050621080220163c7852e2"
    "428929254222fa1f7b238300414e4d4660000000000000000000030000030000640000025650384c47000000"
    "2f03c000107f201048f2375a6c16b16032c9fc2dba850409ffafdacd06d2b6e9748dcb9fad372a103cee0783"
    "f00741d01f0c421004402c78f0a4c48512534a8444f43ff646060100";

void expect_texels(const Image8& image, int tolerance, const std::string& what) {
  const Image8 wanted = expected();
  ASSERT_EQ(image.texels.size(), wanted.texels.size()) << what;
  for (std::size_t i = 0; i < wanted.texels.size(); ++i)
    ASSERT_LE(std::abs(image.texels[i] - wanted.texels[i]), tolerance) << what << ", value " << i;
}

TEST(Alpha, ColoursAreThoseOfTheFileInEveryFormat) {
  const TempFolder folder;
  ASSERT_TRUE(write_png(folder / "a.png", expected(), {}).ok());
  struct File {
    std::string name, bytes;
    int tolerance = 0;
  };
  const File files[] = {{"a.png", TempFolder::read(folder / "a.png")},
                        {"a.tga", tga()},
                        {"a.tif", tiff()},
                        {"a.webp", bytes_of(kLossless)},
                        {"b.webp", bytes_of(kLossy), 3},
                        {"c.webp", bytes_of(kAnimated)}};
  for (const auto& [name, bytes, tolerance] : files) {
    folder.write(name, bytes);
    const auto read = read_image8(folder / name);
    ASSERT_TRUE(read.ok()) << read.status().message();
    expect_texels(*read, tolerance, name);
    const auto floats = read_image_float(folder / name);
    ASSERT_TRUE(floats.ok()) << floats.status().message();
    ASSERT_EQ(floats->texels.size(), read->texels.size());
    for (std::size_t i = 0; i < read->texels.size(); ++i)
      ASSERT_NEAR(floats->texels[i], read->texels[i] / 255.0, 1e-6) << name;
    if (!name.ends_with("png") && !name.ends_with("webp")) continue;
    const auto decoded =
        decode_image8({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()}, name);
    ASSERT_TRUE(decoded.ok()) << decoded.status().message();
    EXPECT_EQ(decoded->texels, read->texels) << name;
  }
}

// Colours of a TIFF may be stored multiplied by alpha. Rounding has left little of those whose
// alpha is small, and nothing where it is 0.
TEST(Alpha, ColoursOfATiffAreNotMultipliedByIt) {
  const TempFolder folder;
  std::string texels = rows("rgba");
  for (std::size_t i = 0; i < texels.size(); ++i)
    if (const int alpha = std::uint8_t(texels[i / 4 * 4 + 3]); i % 4 != 3)
      texels[i] = char((std::uint8_t(texels[i]) * alpha + 127) / 255);
  folder.write("a.tif", tiff(kAssociated, texels));
  const auto read = read_image8(folder / "a.tif");
  const auto floats = read_image_float(folder / "a.tif");
  ASSERT_TRUE(read.ok() && floats.ok());
  const Image8 wanted = expected();
  ASSERT_EQ(read->texels.size(), wanted.texels.size());
  for (std::size_t i = 0; i < wanted.texels.size(); ++i) {
    const int alpha = wanted.texels[i / 4 * 4 + 3];
    if (alpha < 60) continue;
    ASSERT_NEAR(read->texels[i], wanted.texels[i], 128 / alpha) << i;
    ASSERT_NEAR(floats->texels[i], wanted.texels[i] / 255.0, 0.51 / alpha) << i;
  }
}

// Colours of OpenEXR are stored multiplied by alpha. Those beside an alpha of 0 are light that is
// added to what is behind, which no division can give back.
TEST(Alpha, ColoursOfAnExrAreNotMultipliedByIt) {
  const TempFolder folder;
  ImageF stored(5, 1, 4);
  const float texels[20] = {0.2f, 0.1f, 0.05f, 0.25f, 0.5f, 0.25f, 0,    0,    0.8f, 0.4f,
                            0.2f, 1,    0.75f, 0.25f, 0,    0.5f,  0.8f, 0.4f, 2,    1};
  std::copy(texels, texels + 20, stored.texels.begin());
  ASSERT_TRUE(write_exr(folder / "a.exr", stored).ok());
  const float wanted[20] = {0.8f, 0.4f, 0.2f, 0.25f, 0.5f, 0.25f, 0,    0,    0.8f, 0.4f,
                            0.2f, 1,    1.5f, 0.5f,  0,    0.5f,  0.8f, 0.4f, 2,    1};
  const auto floats = read_image_float(folder / "a.exr");
  const auto bytes = read_image8(folder / "a.exr");
  const auto texture = read_texture(folder / "a.exr");
  ASSERT_TRUE(floats.ok() && bytes.ok() && texture.ok());
  EXPECT_TRUE(texture->clipped);
  for (std::size_t i = 0; i < 20; ++i) {
    const double shown = std::min(wanted[i], 1.0f);
    const double code = i % 4 == 3 || shown <= 0 ? shown : 1.055 * std::pow(shown, 1 / 2.4) - 0.055;
    EXPECT_NEAR(floats->texels[i], wanted[i], 1e-3) << i;
    EXPECT_NEAR(bytes->texels[i], 255 * shown, 0.8) << i;
    EXPECT_NEAR(texture->image.texels[i], 255 * code, 0.8) << i;
  }
  // A last channel that is not called alpha is none.
  ImageF three(1, 1, 3, 0.25f);
  ASSERT_TRUE(write_exr(folder / "b.exr", three).ok());
  EXPECT_EQ(read_image_float(folder / "b.exr")->texels, three.texels);
}

// OpenImageIO takes what follows a '?' in a name for options.
TEST(Alpha, NamesMayHoldQuestionMarks) {
  const TempFolder folder;
  std::filesystem::create_directory(folder / "why?a=b");
  ASSERT_TRUE(write_png(folder / "why?a=b" / "a?.png", expected(), {}).ok());
  const std::string png = TempFolder::read(folder / "why?a=b" / "a?.png");
  const std::pair<const char*, std::string> files[] = {
      {"b?c=d.png", png}, {"t?.tif", tiff()}, {"t?.tga", tga()}, {"w?.webp", bytes_of(kLossless)}};
  for (const auto& [name, bytes] : files) {
    folder.write(name, bytes);
    const auto read = read_image8(folder / name);
    ASSERT_TRUE(read.ok()) << read.status().message();
    expect_texels(*read, 0, name);
  }
  const auto read = read_image8(folder / "why?a=b" / "a?.png");
  ASSERT_TRUE(read.ok()) << read.status().message();
  folder.write("no?.png", png.substr(0, 60));
  const test::IgnoreLeaks reader;  // libpng leaves OpenImageIO's functions by longjmp
  const auto cut = read_image8(folder / "no?.png");
  ASSERT_FALSE(cut.ok());
  EXPECT_NE(cut.status().message().find("no?.png"), std::string::npos) << cut.status().message();
}

// Three flags and the name of a chunk change in an animation of a lossy and a lossless frame, and
// nothing else. Chunks of an odd length are padded.
TEST(Alpha, OfWebpIsHiddenInEveryChunkThatTellsIt) {
  const auto chunk = [](const std::string& name, const std::string& bytes) {
    std::string text = name;
    for (int k = 0; k < 4; ++k) text += char(bytes.size() >> (8 * k) & 0xff);
    return text + bytes + std::string(bytes.size() % 2, '\0');
  };
  const auto file = [&](char flags, const std::string& alpha, char lossless) {
    const std::string frame(16, '\x5a');
    const std::string body =
        chunk("VP8X", flags + std::string(9, '\x7f')) + chunk("ANIM", std::string(6, '\x33')) +
        chunk("ANMF",
              frame + chunk(alpha, "\xff\xff\xff") + chunk("VP8 ", std::string(5, '\xff'))) +
        chunk("ANMF",
              frame + chunk("VP8L", "\x2f\xff\xff\xff" + std::string(1, lossless) + "\xff\xff")) +
        chunk("EXIF", std::string(31, '\xff'));
    const std::string text = chunk("RIFF", "WEBP" + body);
    return std::vector<std::uint8_t>(text.begin(), text.end());
  };
  EXPECT_EQ(without_webp_alpha(file('\x3e', "ALPH", '\xff')), file('\x2e', "aLPH", '\xef'));
}

// A file that ends anywhere, and chunks that claim to be longer than the file.
TEST(Alpha, HidingItStaysWithinTheFile) {
  for (const std::string_view hex : {kLossless, kLossy, kAnimated}) {
    const std::string whole = bytes_of(hex);
    for (std::size_t size = 0; size <= whole.size(); ++size)
      for (const bool long_chunk : {false, true}) {
        std::vector<std::uint8_t> file(whole.begin(), whole.begin() + std::ptrdiff_t(size));
        if (long_chunk && size >= 20) std::fill_n(file.begin() + 16, 4, std::uint8_t(255));
        const std::vector<std::uint8_t> hidden = without_webp_alpha(file);
        EXPECT_EQ(hidden.size(), size);
      }
  }
  const std::vector<std::uint8_t> other{'P', 'N', 'G', 0, 0, 0,  0, 0, 0, 0, 0, 0, 'V', 'P', '8',
                                        'X', 10,  0,   0, 0, 16, 0, 0, 0, 3, 0, 0, 3,   0,   0};
  EXPECT_EQ(without_webp_alpha(other), other);
}

}  // namespace
}  // namespace atlas
