// The sizes that image files claim, and the limits of what is believed.
#include "libatlas/image/image_claim.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <vector>

#include "libatlas/image/file_kind.h"
#include "tests/support/file_bytes.h"

namespace atlas {
namespace {

using test::big;
using test::little;

std::optional<ImageClaim> claim(const std::string& text) {
  return claim_of(std::vector<std::uint8_t>(text.begin(), text.end()));
}

// Expects these sizes once the file's first `needed` bytes are there, and nothing before.
void expect_claim(const std::string& file, const ImageClaim& want, std::size_t needed) {
  for (std::size_t cut = 0; cut < needed; ++cut)
    ASSERT_FALSE(claim(file.substr(0, cut))) << cut << " bytes of " << needed;
  for (const std::string& whole : {file.substr(0, needed), file, file + std::string(40, '\0')}) {
    const auto got = claim(whole);
    ASSERT_TRUE(got);
    EXPECT_EQ(got->width, want.width);
    EXPECT_EQ(got->height, want.height);
    EXPECT_EQ(got->channels, want.channels);
  }
}

TEST(ImageClaim, OfAGifFileIsItsScreen) {
  expect_claim("GIF89a" + little(700, 2) + little(300, 2) + "abc", {700, 300, 4}, 10);
  expect_claim("GIF87a" + little(65535, 2) + little(1, 2), {65535, 1, 4}, 10);
}

// The image is what is right of and below its offset.
TEST(ImageClaim, OfAJpeg2000FileIsThatOfItsStream) {
  const std::string stream = "\xff\x4f\xff\x51" + big(47, 2) + big(0, 2) + big(1000, 4) +
                             big(2000, 4) + big(300, 4) + big(1700, 4) + std::string(16, '\7') +
                             big(5, 2);
  expect_claim(stream, {700, 300, 5}, 42);
  const std::string boxes = big(12, 4) + "jP  \r\n\x87\n" + big(0, 4) + "jp2c";
  expect_claim(boxes + stream, {700, 300, 5}, boxes.size() + 42);
  EXPECT_FALSE(claim("\x89PNG\r\n\x1a\n" + stream)) << "it takes no memory to open";
}

TEST(ImageClaim, SidesAndChannelsAreAtLeastOne) {
  EXPECT_TRUE(check_claim({1, 1, 1}, 1, "a").ok());
  for (const ImageClaim& wrong : {ImageClaim{0, 1, 1}, {1, 0, 1}, {1, 1, 0}, {-1, -1, 1}}) {
    const Status status = check_claim(wrong, 1'000'000, "a");
    EXPECT_EQ(status.code(), ErrorCode::bad_input);
    EXPECT_NE(status.message().find("the file is damaged"), std::string::npos);
  }
}

// Each limit itself is still believed. A file's bytes hold values, however wide these are in
// memory.
TEST(ImageClaim, IsBelievedUpToTheLimits) {
  EXPECT_TRUE(check_claim({8192, 8192, 1, 1, 1}, 0, "a").ok()) << "64 MiB";
  EXPECT_EQ(check_claim({8192, 8193, 1, 1, 1}, 0, "a").code(), ErrorCode::bad_input);
  constexpr std::uint64_t kValues = 8192 * 8192 * 3;
  for (const double packing : {1.0, 4.0}) {
    const std::uint64_t least = kValues / std::uint64_t(packing);
    EXPECT_TRUE(check_claim({8192, 8192, 3, 4, packing}, least, "a").ok());
    const Status status = check_claim({8192, 8192, 3, 4, packing}, least - 1, "a.tif");
    EXPECT_EQ(status.code(), ErrorCode::bad_input);
    EXPECT_EQ(status.message().rfind("a.tif: claims 8192 x 8192 texels of 3 channels (768 MiB)", 0),
              0u)
        << status.message();
  }
  EXPECT_TRUE(check_claim({16384, 16384, 4, 4, kPackedByte}, 1 << 30, "a").ok());
  EXPECT_EQ(check_claim({16384, 16385, 4, 4, kPackedByte}, 1 << 30, "a").code(),
            ErrorCode::unsupported);
}

TEST(ImageClaim, RunsInABmpFileNeedAPalette) {
  const auto lacks = [](int bits, int compression, char header = 40) {
    std::string head = "BM" + std::string(12, '\1') + header + std::string(39, '\0');
    head[28] = char(bits);
    head[30] = char(compression);
    return bmp_lacks_palette(std::vector<std::uint8_t>(head.begin(), head.end()));
  };
  for (const int bits : {1, 4, 8, 16, 24, 32}) {
    for (const int compression : {0, 1, 2, 3}) {
      const bool runs = compression == 1 || compression == 2;
      EXPECT_EQ(lacks(bits, compression), runs && bits > 8) << bits << ' ' << compression;
      EXPECT_FALSE(lacks(bits, compression, 12)) << "the oldest header has no compression";
    }
  }
}

// Headers of OpenEXR files. Of a single part, what follows its header are texels.
TEST(ImageClaim, AttributesOfAnExrFileLieWithinIt) {
  const auto attribute = [](const std::string& name, std::uint32_t length,
                            const std::string& value) {
    return name + std::string("\0string\0", 8) + little(length, 4) + value;
  };
  const auto overclaims = [](bool several, const std::string& rest) {
    const std::string head = std::string("\x76\x2f\x31\x01\x02", 5) + (several ? '\x10' : '\0') +
                             std::string(2, '\0') + rest;
    return exr_overclaims(std::vector<std::uint8_t>(head.begin(), head.end()), head.size());
  };
  const std::string end(1, '\0'), value(300, 'v');
  const std::string sound = attribute("owner", 300, value), wrong = attribute("owner", 9999, value);
  for (const bool several : {false, true}) {
    EXPECT_FALSE(overclaims(several, sound + sound + end + end + wrong)) << several;
    EXPECT_TRUE(overclaims(several, wrong)) << several;
    EXPECT_TRUE(overclaims(several, sound + sound + wrong + end)) << several;
    EXPECT_EQ(overclaims(several, sound + end + wrong + end + end), several);
    EXPECT_EQ(overclaims(several, sound + end + sound + end + wrong), several);
    const std::string holding = attribute("owner", std::uint32_t(wrong.size()), wrong);
    EXPECT_FALSE(overclaims(several, holding + end + end)) << "what an attribute holds is none";
  }
}

TEST(ImageKind, IsToldByTheFirstBytes) {
  const auto kind = [](const std::string& s) {
    return image_extension(std::vector<std::uint8_t>(s.begin(), s.end()));
  };
  EXPECT_EQ(kind("\x89PNG\r\n\x1a\nrest"), ".png");
  EXPECT_EQ(kind("\x89PNG\r\n\x1a\n"), ".png");
  EXPECT_EQ(kind("\x89PNG\n\x1a\nrest"), "") << "line ends that were changed";
  EXPECT_EQ(kind("\xff\xd8\xff\xe0"), ".jpg");
  for (const char* other : {"", "\xff\xd8", "\x89PNG\r\n\x1a", "RIFF", "GIF89a"})
    EXPECT_EQ(kind(other), "");
}

}  // namespace
}  // namespace atlas
