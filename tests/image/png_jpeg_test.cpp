// PNG and JPEG files are read as OpenImageIO reads them, which the module still does.
#include <gtest/gtest.h>
#include <zlib.h>

#include <cstring>
#include <string>
#include <vector>

#include "libatlas/core/clock.h"
#include "libatlas/image/image_io.h"
#include "libatlas/image/image_module.h"
#include "tests/image/image_kinds.h"
#include "tests/support/file_bytes.h"
#include "tests/support/temp_folder.h"

namespace atlas {
namespace {

using test::big;
using test::ImageOfKind;
using test::TempFolder;

std::vector<std::uint8_t> bytes_of(const std::string& file) {
  return {file.begin(), file.end()};
}

template <class T>
void expect_same(const Result<Image<T>>& read, const Result<Image<T>>& wanted) {
  ASSERT_TRUE(wanted.ok()) << wanted.status().message();
  ASSERT_TRUE(read.ok()) << read.status().message();
  EXPECT_EQ(read->width, wanted->width);
  EXPECT_EQ(read->height, wanted->height);
  EXPECT_EQ(read->channels, wanted->channels);
  EXPECT_EQ(read->texels, wanted->texels);
}

void expect_read_alike(const std::vector<ImageOfKind>& files) {
  ASSERT_TRUE(image_module().functions) << image_module().why_not;
  const ImageFiles& oracle = *image_module().functions;
  const TempFolder folder;
  for (const ImageOfKind& file : files) {
    SCOPED_TRACE(file.kind);
    const auto path = folder.write("a.image", file.bytes);
    expect_same(read_image8(path), oracle.read_image8(path));
    expect_same(read_image_float(path), oracle.read_image_float(path));
    expect_same(decode_image8(bytes_of(file.bytes), "a"), read_image8(path));
  }
}

TEST(PngJpeg, PngFilesOfEveryKindAreReadAsBefore) {
  expect_read_alike(test::png_kinds());
}

TEST(PngJpeg, JpegFilesOfEveryKindAreReadAsBefore) {
  expect_read_alike(test::jpeg_kinds());
}

TEST(PngJpeg, WrittenFilesAreReadAlike) {
  ASSERT_TRUE(image_module().functions) << image_module().why_not;
  const TempFolder folder;
  for (int channels = 1; channels <= 4; ++channels)
    for (const bool smooth : {false, true}) {
      Image8 image(13, 6, channels);
      for (std::size_t i = 0; i < image.texels.size(); ++i)
        image.texels[i] = std::uint8_t(i * i * 7 + i);
      ASSERT_TRUE(write_png(folder / "a.png", image, {3, smooth}).ok());
      expect_same(image_module().functions->read_image8(folder / "a.png"), Result<Image8>(image));
    }
}

// A file may lack its end mark, which holds no texel.
void expect_damage_is_told(const std::string& whole, std::size_t needed) {
  const TempFolder folder;
  ASSERT_TRUE(read_image8(folder.write("a.image", whole)).ok());
  for (std::size_t cut = 8; cut < needed; ++cut) {
    const auto path = folder.write("a.image", whole.substr(0, cut));
    const auto read = read_image8(path);
    ASSERT_FALSE(read.ok()) << cut << " bytes of " << whole.size();
    EXPECT_EQ(read.status().code(), ErrorCode::io);
    const std::string& message = read.status().message();
    EXPECT_EQ(message.rfind(path.string() + ": image is damaged: ", 0), 0u) << message;
    EXPECT_EQ(message.find('\n'), message.npos) << message;
    EXPECT_FALSE(decode_image8(bytes_of(whole.substr(0, cut)), "a").ok());
  }
}

TEST(PngJpeg, CutPngFilesAreRefused) {
  for (const ImageOfKind& file : test::png_kinds()) {
    if (file.bytes.size() > 400) continue;
    SCOPED_TRACE(file.kind);
    constexpr std::size_t kEnd = 12 + 4;  // the last chunk, and the checksum before it
    expect_damage_is_told(file.bytes, file.bytes.size() - kEnd);
  }
}

// Decoders read some bits ahead, so the last byte of the texels is not always missed.
TEST(PngJpeg, CutJpegFilesAreRefused) {
  for (const ImageOfKind& file : test::jpeg_kinds()) {
    if (file.kind.find("progressive true") != std::string::npos) continue;
    SCOPED_TRACE(file.kind);
    constexpr std::size_t kEnd = 2 + 2;
    expect_damage_is_told(file.bytes, file.bytes.size() - kEnd);
  }
}

TEST(PngJpeg, ChangedPngFilesAreRefused) {
  const TempFolder folder;
  std::string file = test::png_kinds().back().bytes;
  for (std::size_t at = 8; at + 16 < file.size(); ++at) {
    file[at] = char(file[at] ^ 0x55);
    EXPECT_FALSE(read_image8(folder.write("a.png", file)).ok()) << at;
    file[at] = char(file[at] ^ 0x55);
  }
}

std::string chunk(const std::string& type, const std::string& data) {
  const std::string body = type + data;
  const auto sum = crc32(0, reinterpret_cast<const Bytef*>(body.data()), uInt(body.size()));
  return big(std::uint32_t(data.size()), 4) + body + big(std::uint32_t(sum), 4);
}

// Forty texts of 8 kB, of which each unpacks to 8 MB.
TEST(PngJpeg, TextsOfAPngTakeNoMemory) {
  const std::string text(7'900'000, 'a');
  uLongf size = compressBound(text.size());
  std::string packed(size, '\0');
  ASSERT_EQ(compress2(reinterpret_cast<Bytef*>(packed.data()), &size,
                      reinterpret_cast<const Bytef*>(text.data()), text.size(), 9),
            Z_OK);
  packed.resize(size);
  std::string file = test::png_kinds().back().bytes;
  constexpr std::size_t kHeader = 8 + 25;
  for (int i = 0; i < 40; ++i)
    file.insert(kHeader, chunk("zTXt", std::string("a\0\0", 3) + packed));
  const std::int64_t before = peak_memory();
  EXPECT_TRUE(decode_image8(bytes_of(file), "a").ok());
  EXPECT_LT(peak_memory() - before, std::int64_t{100} << 20);
}

// Each scan takes the time of a whole image, and few bytes.
TEST(PngJpeg, AJpegOfCountlessScansIsRefused) {
  EXPECT_TRUE(decode_image8(bytes_of(test::jpeg_of_scans(1)), "a").ok());
  const auto read = decode_image8(bytes_of(test::jpeg_of_scans(600)), "a");
  ASSERT_FALSE(read.ok());
  EXPECT_EQ(read.status().message(), "a: image is damaged: it has more than 500 scans");
}

}  // namespace
}  // namespace atlas
