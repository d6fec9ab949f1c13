// The sides that headers state, as decoders find them.
#include "libatlas/image/image_sides.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "libatlas/image/image_io.h"
#include "tests/support/temp_folder.h"

namespace atlas {
namespace {

std::optional<ImageSides> sides_of(const std::string& bytes) {
  std::string head = bytes;
  head.resize(64);
  return sides_in_header({reinterpret_cast<const std::uint8_t*>(head.data()), head.size()});
}

// A header of 64 bytes or less, with 300 x 200 texels.
const std::vector<std::pair<const char*, std::string>> kHeaders{
    {"gif", std::string("GIF89a\x2c\x01\xc8\x00", 10)},
    {"bmp", "BM" + std::string(16, '\0') + std::string("\x2c\x01\0\0\x38\xff\xff\xff", 8)},
    {"jpeg", std::string("\xff\xd8\xff\xe0\0\4ab\xff\xc2\0\x11\x08\0\xc8\1\x2c", 17)},
    {"webp, extended", std::string("RIFF....WEBPVP8X", 16) + std::string(8, '\0') +
                           std::string("\x2b\x01\0\xc7\0\0", 6)},
    {"webp, lossy", std::string("RIFF....WEBPVP8 ", 16) + std::string(10, '\0') +
                        std::string("\x2c\x01\xc8\0", 4)},
    {"webp, lossless",
     std::string("RIFF....WEBPVP8L....\x2f", 21) + std::string("\x2b\xc1\x31\0", 4)},
    {"tiff", std::string("II*\0\x08\0\0\0\2\0\0\1\3\0\1\0\0\0\x2c\1\0\0\1\1\4\0\1\0\0\0\xc8\0"
                         "\0\0",
                         34)}};

TEST(ImageSides, AreThoseOfTheHeader) {
  for (const auto& [format, bytes] : kHeaders) {
    const auto sides = sides_of(bytes);
    ASSERT_TRUE(sides) << format;
    EXPECT_EQ(sides->width, 300) << format;
    EXPECT_EQ(sides->height, 200) << format;
  }
  const test::TempFolder folder;
  ASSERT_TRUE(write_png(folder / "a.png", Image8(300, 200, 3), {}).ok());
  const auto png = image_sides(folder / "a.png");
  ASSERT_TRUE(png);
  EXPECT_EQ(png->width, 300);
  EXPECT_EQ(png->height, 200);
}

TEST(ImageSides, AreUnknownOtherwise) {
  EXPECT_FALSE(sides_of("no image at all"));
  EXPECT_FALSE(sides_in_header({}));
  const test::TempFolder folder;
  EXPECT_FALSE(image_sides(folder / "missing.png"));
  EXPECT_FALSE(image_sides(folder.write("short.png", "\x89PNG")));
  // Headers that are cut anywhere end the search.
  for (const auto& [format, bytes] : kHeaders)
    for (std::size_t size = 0; size < bytes.size(); ++size)
      static_cast<void>(
          sides_in_header({reinterpret_cast<const std::uint8_t*>(bytes.data()), size}));
}

}  // namespace
}  // namespace atlas
