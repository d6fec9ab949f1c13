// Tests files that claim more than they hold, or more than anyone should read.
#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "libatlas/core/clock.h"
#include "libatlas/image/image_claim.h"
#include "libatlas/image/image_io.h"
#include "tests/support/file_bytes.h"
#include "tests/support/leaks.h"
#include "tests/support/temp_folder.h"

namespace atlas {
namespace {

using test::big;
using test::little;
using test::TempFolder;

std::string chunk(const std::string& type, const std::string& data) {
  const std::string body = type + data;
  const auto sum = crc32(0, reinterpret_cast<const Bytef*>(body.data()), uInt(body.size()));
  return big(std::uint32_t(data.size()), 4) + body + big(std::uint32_t(sum), 4);
}

std::string deflated(const std::string& raw) {
  uLongf size = compressBound(raw.size());
  std::string packed(size, '\0');
  compress2(reinterpret_cast<Bytef*>(packed.data()), &size,
            reinterpret_cast<const Bytef*>(raw.data()), raw.size(), 9);
  packed.resize(size);
  return packed;
}

// Makes a PNG file. `kind`: bits, colour type, compression, filter, interlace.
std::string png(std::uint32_t width, std::uint32_t height, const std::string& kind,
                const std::string& raw) {
  const bool palette = kind[1] == 3;
  return "\x89PNG\r\n\x1a\n" + chunk("IHDR", big(width, 4) + big(height, 4) + kind) +
         (palette ? chunk("PLTE", "\x10\x20\x30") + chunk("tRNS", "\x40") : "") +
         chunk("IDAT", deflated(raw)) + chunk("IEND", "");
}

const std::string kRgb("\x08\x02\0\0\0", 5), kInterlaced("\x08\x02\0\0\1", 5);

std::string jpeg(std::uint32_t side, char frame) {
  const std::string table =
      std::string("\1") + std::string(15, '\0') + '\0';  // one code of one bit
  const std::string scan = frame == '\xc2' ? std::string(3, '\0') : std::string("\0\x3f\0", 3);
  return "\xff\xd8\xff\xdb" + big(67, 2) + '\0' + std::string(64, '\1') + "\xff" + frame +
         big(17, 2) + '\x08' + big(side, 2) + big(side, 2) +
         std::string("\3\1\x11\0\2\x11\0\3\x11\0", 10) + "\xff\xc4" + big(20, 2) + '\0' + table +
         "\xff\xc4" + big(20, 2) + '\x10' + table + "\xff\xda" + big(12, 2) +
         std::string("\3\1\0\2\0\3\0", 7) + scan + std::string(4, '\0') + "\xff\xd9";
}

std::string tiff(std::uint32_t side, std::uint32_t compression) {
  const std::vector<std::array<std::uint32_t, 2>> entries = {
      {256, side}, {257, side}, {258, 8},    {259, compression}, {262, 2},
      {273, 8},    {277, 3},    {278, side}, {279, 16}};
  std::string s = std::string("II*\0", 4) + little(24, 4) + std::string(16, '\0');
  s += little(std::uint32_t(entries.size()), 2);
  for (const auto& [tag, value] : entries)
    s += little(tag, 2) + little(4, 2) + little(1, 4) + little(value, 4);
  return s + little(0, 4);
}

std::string webp(std::uint32_t side) {
  const std::string size = little((side - 1) | (side - 1) << 14 | 1u << 28, 4);
  const std::string body = std::string("\x2f") + size + std::string(9, '\0');
  return "RIFF" + little(std::uint32_t(body.size()) + 12, 4) + "WEBPVP8L" +
         little(std::uint32_t(body.size()), 4) + body;
}

std::string jpeg2000(std::uint32_t side) {
  const std::string sides = big(side, 4) + big(side, 4), none(8, '\0');
  return "\xff\x4f\xff\x51" + big(47, 2) + big(0, 2) + sides + none + sides + none + big(3, 2) +
         "\7\1\1\7\1\1\7\1\1" + std::string("\xff\x52\0\x0c\0\0\0\1\0\5\4\4\0\1", 14) + "\xff\x5c" +
         big(19, 2) + '\x40' + std::string(16, '\x48') +
         std::string("\xff\x90\0\x0a\0\0\0\0\0\0\0\1\xff\x93", 14) + std::string(8, '\0');
}

std::string exif(std::size_t bytes) {
  std::string s;
  for (; bytes > 0; bytes -= std::min<std::size_t>(bytes, 65000)) {
    const auto part = std::uint32_t(std::min<std::size_t>(bytes, 65000));
    s += "\xff\xe1" + big(part + 2, 2) + std::string(part, '\xc2');
  }
  return s;
}

struct Hostile {
  std::string name, bytes;
};

std::string gif(const std::string& signature) {
  const std::string side = little(60000, 2) + little(60000, 2);
  return signature + side + std::string("\x80\0\0", 3) + std::string(6, '\0') + ',' +
         std::string(4, '\0') + side + std::string("\0\2\2\x4c\1\0;", 7);
}

std::vector<Hostile> hostile_files() {
  const std::string jpg = jpeg(60000, '\xc2');
  return {{"plain.png", png(60000, 60000, kRgb, "")},
          {"interlaced.png", png(60000, 60000, kInterlaced, "")},
          {"page.png", png(16384, 16384, kRgb, "")},
          {"baseline.jpg", jpeg(60000, '\xc0')},
          {"progressive.jpg", jpg},
          {"exif.jpg", jpg.substr(0, 2) + exif(200'000) + jpg.substr(2)},
          {"a.gif", gif("GIF89a")},
          {"b.gif", gif("GIF70x")},
          {"strips.tif", tiff(60000, 1)},
          {"deflated.tif", tiff(60000, 8)},
          {"a.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 60000 +X 60000\n\2\2"},
          {"a.webp", webp(16383)},
          {"a.j2k", jpeg2000(60000)},
          {"a.jp2", big(12, 4) + "jP  \r\n\x87\n" + big(0, 4) + "jp2c" + jpeg2000(60000)},
          {"a.tga", std::string("\0\0\2\0\0\0\0\0\0\0\0\0", 12) + little(60000, 2) +
                        little(60000, 2) + std::string("\x18\0\xff\xff\xff", 5)}};
}

// Since version 3.1, readers of OpenImageIO refuse some of these files by themselves, and name the
// size that is claimed in words of their own.
bool tells_what_is_claimed(const std::string& message, const std::string& path) {
  const auto has = [&](const std::string& words) { return message.find(words) != message.npos; };
  if (has(path + ": claims ")) return has("cannot hold");
  return has(path + ": cannot be read as an image: ") &&
         (has("claims") || has("exceeds the") || has("implausible"));
}

TEST(HostileImage, NoMemoryForWhatAFileCannotHold) {
  const TempFolder folder;
  const test::IgnoreLeaks readers;  // libpng and libjpeg leave OpenImageIO's functions by longjmp
  for (const Hostile& file : hostile_files()) {
    const auto path = folder.write(file.name, file.bytes);
    const auto read = read_image8(path);
    ASSERT_FALSE(read.ok()) << file.name;
    const std::string& message = read.status().message();
    EXPECT_TRUE(tells_what_is_claimed(message, path.string())) << message;
    EXPECT_FALSE(read_image_float(path).ok()) << file.name;
  }
  EXPECT_LT(peak_memory(), std::int64_t{800} << 20);
}

TEST(HostileImage, EmbeddedOnesAreJudgedAsFilesAre) {
  for (const Hostile& file : hostile_files()) {
    const std::vector<std::uint8_t> bytes(file.bytes.begin(), file.bytes.end());
    const auto read = decode_image8(bytes, "scene.glb: image 4");
    ASSERT_FALSE(read.ok()) << file.name;
    EXPECT_EQ(read.status().message().rfind("scene.glb: image 4: c", 0), 0u)
        << read.status().message();
  }
  EXPECT_LT(peak_memory(), std::int64_t{800} << 20);
}

// A palette of one colour, deflated, is the most that a byte of PNG can hold.
TEST(HostileImage, LargePlainImagesAreRead) {
  const TempFolder folder;
  constexpr int kWidth = 16384, kHeight = 2048;
  const std::string raw(std::size_t(kHeight) * (kWidth / 8 + 1), '\0');
  const auto path = folder.write("a.png", png(kWidth, kHeight, std::string("\1\3\0\0\0", 5), raw));
  ASSERT_LT(std::filesystem::file_size(path), 6000u);
  const auto read = read_image8(path);
  ASSERT_TRUE(read.ok()) << read.status().message();
  EXPECT_EQ(read->channels, 4);
  EXPECT_EQ(*read->at(kWidth - 1, kHeight - 1), 0x10);
}

TEST(HostileImage, TheLimitLetsTheLargestPagesPass) {
  const std::uint64_t large = 100 << 20;
  EXPECT_TRUE(check_claim({16384, 16384, 4, sizeof(float), kPackedByte}, large, "a").ok());
  EXPECT_TRUE(check_claim({32768, 32768, 4, 1, kPackedByte}, large, "a").ok());
  EXPECT_TRUE(check_claim({16384, 16384, 4, 1, kPackedByte}, 40'000, "a").ok());
  const Status s = check_claim({32769, 32768, 4, 1, kPackedByte}, large, "a.png");
  EXPECT_EQ(s.code(), ErrorCode::unsupported);
  EXPECT_EQ(s.message(),
            "a.png: claims 32769 x 32768 texels of 4 channels (4.0 GiB), and at most 4.0 GiB are "
            "read: make the image smaller");
  EXPECT_EQ(check_claim({0, 5, 3, 1, 1}, large, "a").code(), ErrorCode::bad_input);
}

// As 8-bit values this image takes little more than 1 GiB.
TEST(HostileImage, TheLimitIsThatOfTheValuesInMemory) {
  const TempFolder folder;
  const std::string rest(60'000, '\0');
  const auto path = folder.write(
      "a.png", png(32768, 32769, std::string("\x08\0\0\0\0", 5), "") + chunk("teXt", rest));
  const Status status = read_image_float(path).status();
  EXPECT_EQ(status.code(), ErrorCode::unsupported);
  EXPECT_NE(status.message().find("(4.0 GiB), and at most 4.0 GiB are read"), std::string::npos)
      << status.message();
}

std::string bmp(std::uint32_t bits, std::uint32_t compression, const std::string& rest) {
  return "BM" + little(54 + std::uint32_t(rest.size()), 4) + little(0, 4) + little(54, 4) +
         little(40, 4) + little(2, 4) + little(1, 4) + little(1, 2) + little(bits, 2) +
         little(compression, 4) + std::string(20, '\0') + rest;
}

// OpenImageIO looked for palette entries where there was no palette, and crashed.
TEST(HostileImage, RunsOfABitmapNeedAPalette) {
  const TempFolder folder;
  const std::string runs("\2\5\0\1", 4), palette(256 * 4, '\x30');
  for (const std::uint32_t bits : {16, 24, 32})
    for (const std::uint32_t compression : {1, 2}) {
      const auto read = read_image8(folder.write("a.bmp", bmp(bits, compression, runs)));
      ASSERT_FALSE(read.ok());
      EXPECT_NE(read.status().message().find("a.bmp: image is damaged: it is compressed, but has "
                                             "no palette (save it anew)"),
                std::string::npos)
          << read.status().message();
    }
  const auto whole = read_image8(folder.write("a.bmp", bmp(8, 1, palette + runs)));
  ASSERT_TRUE(whole.ok()) << whole.status().message();
  EXPECT_EQ(whole->width, 2);
  EXPECT_EQ(*whole->at(1, 0), 0x30);
}

// A file of several parts, where this is found in the second. OpenEXR took a gigabyte.
TEST(HostileImage, NoMemoryForAttributesOfHalfAFile) {
  const TempFolder folder;
  const auto attribute = [](std::uint32_t length, const std::string& value) {
    return std::string("a\0opaque\0", 9) + little(length, 4) + value;
  };
  const std::string start("\x76\x2f\x31\1\2\x10\0\0", 8), part = attribute(3, "abc") + '\0';
  for (const std::uint32_t length : {1u << 30, ~0u}) {
    const auto path = folder.write("a.exr", start + part + attribute(length, "abc"));
    const auto read = read_image_float(path);
    ASSERT_FALSE(read.ok());
    EXPECT_EQ(read.status().message(), path.string() +
                                           ": image is damaged: its header claims more "
                                           "than it holds (save it anew)");
  }
  EXPECT_LT(peak_memory(), std::int64_t{800} << 20);
  const std::string whole = start + part + part + '\0';
  const auto judged = [&](std::size_t bytes) {
    const std::string head = whole.substr(0, bytes);
    return exr_overclaims({reinterpret_cast<const std::uint8_t*>(head.data()), bytes}, bytes);
  };
  EXPECT_FALSE(judged(whole.size()));
  EXPECT_TRUE(judged(8 + 9 + 4 + 2));  // within the first value
  EXPECT_FALSE(judged(8 + 5));         // within a type: nothing is claimed yet
}

// Two rows that claim 200 MB, which the bytes may stand for. OpenImageIO took memory for 256 of
// them.
TEST(HostileImage, RowsAreNotLongerThanAnyImage) {
  const TempFolder folder;
  ASSERT_TRUE(write_exr(folder / "a.exr", ImageF(3, 2, 3)).ok());
  std::string bytes = TempFolder::read(folder / "a.exr");
  const std::size_t window = bytes.find("dataWindow");
  ASSERT_NE(window, bytes.npos);
  constexpr std::size_t kHighest = 11 + 6 + 4 + 8 + 3;  // byte of the last column
  bytes[window + kHighest] = 1;
  const auto path = folder.write("b.exr", bytes);
  const auto read = read_image8(path);
  ASSERT_FALSE(read.ok());
  EXPECT_EQ(read.status().code(), ErrorCode::unsupported) << read.status().message();
  EXPECT_NE(read.status().message().find("its rows are"), std::string::npos)
      << read.status().message();
}

// OpenImageIO gives two lines for it.
TEST(HostileImage, ErrorsAreOneLine) {
  const test::IgnoreLeaks readers;  // libpng leaves OpenImageIO's functions by longjmp
  const TempFolder folder;
  const std::string whole = png(1, 1, kRgb, std::string(4, '\0'));
  const auto read = read_image8(folder.write("a.png", whole.substr(0, 33) + big(9, 4) + "oFFs"));
  ASSERT_FALSE(read.ok());
  EXPECT_EQ(read.status().message().find('\n'), std::string::npos) << read.status().message();
}

// For these files, the readers only gave a message, and the missing rest was grey or black.
TEST(HostileImage, CutFilesAreNotTakenForWholeOnes) {
  const TempFolder folder;
  for (const Hostile& file :
       {Hostile{"a.jpg", jpeg(200, '\xc0')}, Hostile{"a.tif", tiff(200, 1)}}) {
    const auto read = read_image8(folder.write(file.name, file.bytes));
    ASSERT_FALSE(read.ok()) << file.name;
    EXPECT_NE(read.status().message().find("image is damaged"), std::string::npos);
    EXPECT_EQ(read.status().message().find('\n'), std::string::npos);
  }
}

TEST(HostileImage, HarmlessComplaintsAreNotDamage) {
  const TempFolder folder;
  std::string whole = jpeg(8, '\xc0');
  whole.insert(2, std::string(3, '\0'));  // stray bytes, which decoders skip
  const auto read = read_image8(folder.write("a.jpg", whole));
  ASSERT_TRUE(read.ok()) << read.status().message();
  EXPECT_EQ(read->width, 8);
}

}  // namespace
}  // namespace atlas
