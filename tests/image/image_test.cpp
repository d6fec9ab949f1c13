#include "libatlas/image/image_io.h"

#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <numeric>
#include <random>

#include "tests/support/full_disk.h"
#include "tests/support/leaks.h"
#include "tests/support/temp_folder.h"

namespace atlas {
namespace {

using test::TempFolder;

Image8 noise(int width, int height, int channels) {
  Image8 image(width, height, channels);
  std::mt19937 random(std::uint32_t(width * 31 + channels));
  for (std::uint8_t& texel : image.texels) texel = std::uint8_t(random());
  return image;
}

std::uint32_t big_endian(const std::string& bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (int i = 0; i < 4; ++i) value = value << 8 | std::uint8_t(bytes[at + i]);
  return value;
}

// If there were fewer texels than the sizes say, writing would read past their end.
TEST(Image, ImagesOutOfStepAreRefused) {
  const TempFolder folder;
  Image8 image = noise(37, 5, 3);
  image.texels.resize(100);
  Status status = write_png(folder / "a.png", image, {});
  EXPECT_EQ(status.code(), ErrorCode::bad_input);
  EXPECT_NE(status.message().find("37 x 5 with 3 channels, but holds 100 values"),
            std::string::npos)
      << status.message();
  EXPECT_EQ(write_png(folder / "a.png", noise(4, 4, 5), {}).code(), ErrorCode::bad_input);
  EXPECT_EQ(write_png(folder / "a.png", {}, {}).code(), ErrorCode::bad_input);
  EXPECT_EQ(write_png(folder / "a.png", {4, 4, 0}, {}).code(), ErrorCode::bad_input);
  for (const int level : {-1, 10})
    EXPECT_EQ(write_png(folder / "a.png", noise(4, 4, 3), {level}).code(), ErrorCode::bad_option);
  ImageF linear(4, 4, 3);
  linear.texels.pop_back();
  EXPECT_EQ(write_exr(folder / "a.exr", linear).code(), ErrorCode::bad_input);
  linear = {};
  linear.width = linear.height = 1 << 30;
  linear.channels = 16;  // the product wraps around to the number of texels, which is 0
  EXPECT_EQ(write_exr(folder / "a.exr", linear).code(), ErrorCode::bad_input);
  EXPECT_EQ(write_exr(folder / "a.exr", ImageF(1, 1, 1025)).code(), ErrorCode::bad_input);
  EXPECT_FALSE(std::filesystem::exists(folder / "a.png"));
}

// Replaces the display window in the header of an OpenEXR file.
std::string with_display_window(std::string bytes, const std::array<std::int32_t, 4>& corners) {
  const std::string name("displayWindow\0box2i\0\x10\0\0\0", 24);
  const std::size_t at = bytes.find(name);
  EXPECT_NE(at, std::string::npos);
  std::memcpy(bytes.data() + at + name.size(), corners.data(), sizeof corners);  // little-endian
  return bytes;
}

// Renderers store the part of a picture that is not empty, or more than is shown.
TEST(Image, OpenExrFilesAreReadAsTheyAreShown) {
  const TempFolder folder;
  ImageF stored(4, 3, 2);
  std::iota(stored.texels.begin(), stored.texels.end(), 1.0f);
  ASSERT_TRUE(write_exr(folder / "a.exr", stored).ok());
  const std::string bytes = TempFolder::read(folder / "a.exr");
  // Left, top, right and bottom, the last two inclusive, of windows around the stored texels,
  // inside them, across their corner, and beside them.
  for (const std::array<std::int32_t, 4> window :
       {std::array{-2, -1, 5, 6}, {1, 1, 2, 1}, {2, -3, 9, 0}, {0, 0, 3, 2}, {10, 10, 11, 12}}) {
    const auto path = folder.write("b.exr", with_display_window(bytes, window));
    const Result<ImageF> shown = read_image_float(path);
    ASSERT_TRUE(shown.ok()) << shown.status().message();
    ASSERT_EQ(shown->width, window[2] - window[0] + 1);
    ASSERT_EQ(shown->height, window[3] - window[1] + 1);
    for (int y = window[1]; y <= window[3]; ++y) {
      for (int x = window[0]; x <= window[2]; ++x) {
        const bool held = x >= 0 && x < 4 && y >= 0 && y < 3;
        for (int c = 0; c < 2; ++c)
          EXPECT_EQ(shown->at(x - window[0], window[3] - y)[c], held ? stored.at(x, 2 - y)[c] : 0)
              << x << ' ' << y;
      }
    }
  }
  const auto vast = folder.write("c.exr", with_display_window(bytes, {0, 0, 1 << 20, 1 << 20}));
  EXPECT_EQ(read_image_float(vast).status().code(), ErrorCode::bad_input);
}

TEST(Image, PngReadsBackExactly) {
  const TempFolder folder;
  for (int channels = 1; channels <= 4; ++channels) {
    for (const int compression : {0, 3, 9}) {
      const Image8 image = noise(37, 5, channels);
      ASSERT_TRUE(write_png(folder / "a.png", image, {compression}).ok());
      const auto read = read_image8(folder / "a.png");
      ASSERT_TRUE(read.ok()) << read.status().message();
      EXPECT_EQ(read->width, 37);
      EXPECT_EQ(read->channels, channels);
      EXPECT_EQ(read->texels, image.texels) << channels << " channels";
    }
  }
}

// Baked pages look like this: slopes with a little noise. Levels 1 to 5 give the same file.
TEST(Image, SmoothPngReadsBackExactlyAndTakesLessRoom) {
  const TempFolder folder;
  Image8 image = noise(300, 200, 3);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      for (int k = 0; k < 3; ++k) {
        std::uint8_t& t = image.at(x, y)[k];
        t = static_cast<std::uint8_t>(x / 3 + y / 4 + 10 * k + t % 2);
      }
  const auto file = [&](const PngOptions& options) {
    EXPECT_TRUE(write_png(folder / "a.png", image, options).ok());
    const auto read = read_image8(folder / "a.png");
    EXPECT_TRUE(read.ok() && read->texels == image.texels);
    return TempFolder::read(folder / "a.png");
  };
  const std::string smooth = file({3, true});
  EXPECT_LT(smooth.size(), file({3}).size());
  EXPECT_LT(smooth.size(), 1.05 * static_cast<double>(file({6}).size()));
  EXPECT_EQ(file({1, true}), file({5, true}));
  EXPECT_EQ(file({9, true}), file({9}));
  EXPECT_GT(file({0, true}).size(), image.texels.size());
}

// Checks the file's own bytes, which are unfiltered by hand. Row 0 in memory is the bottom row.
TEST(Image, PngRowsAreTopDownInTheFile) {
  const TempFolder folder;
  Image8 image(1, 2, 3, 0);
  const std::uint8_t bottom[3] = {10, 20, 30}, top[3] = {200, 100, 50};
  std::copy(bottom, bottom + 3, image.at(0, 0));
  std::copy(top, top + 3, image.at(0, 1));
  ASSERT_TRUE(write_png(folder / "a.png", image, {}).ok());
  const std::string file = TempFolder::read(folder / "a.png");
  EXPECT_EQ(file.substr(1, 3), "PNG");
  EXPECT_EQ(big_endian(file, 16), 1u);
  EXPECT_EQ(big_endian(file, 20), 2u);
  EXPECT_EQ(file[24], 8);  // bits
  EXPECT_EQ(file[25], 2);  // RGB without alpha
  std::string packed;
  for (std::size_t at = 8; at + 12 <= file.size(); at += 12 + big_endian(file, at)) {
    if (file.substr(at + 4, 4) == "IDAT") packed += file.substr(at + 8, big_endian(file, at));
  }
  unsigned char rows[8];
  uLongf size = sizeof rows;
  ASSERT_EQ(uncompress(rows, &size, reinterpret_cast<const Bytef*>(packed.data()), packed.size()),
            Z_OK);
  ASSERT_EQ(size, 8u);
  int first[3], second[3];
  for (int c = 0; c < 3; ++c) {  // filters none, sub, up, average, paeth, for one texel per row
    first[c] = rows[1 + c];
    const int filter = rows[4], above = filter == 0 || filter == 1 ? 0 : first[c];
    second[c] = (rows[5 + c] + (filter == 3 ? above / 2 : above)) & 255;
  }
  for (int c = 0; c < 3; ++c) {
    EXPECT_EQ(first[c], top[c]);
    EXPECT_EQ(second[c], bottom[c]);
  }
}

TEST(Image, ColoursUnderAlphaStayAsStored) {
  const TempFolder folder;
  Image8 image(2, 1, 4, 0);
  const std::uint8_t texels[8] = {200, 150, 100, 0, 7, 8, 9, 128};
  std::copy(texels, texels + 8, image.texels.begin());
  ASSERT_TRUE(write_png(folder / "a.png", image, {}).ok());
  EXPECT_EQ(read_image8(folder / "a.png")->texels, image.texels);
}

// The codes 200, 100 and 50 are 0.5776, 0.1274 and 0.0319. OpenEXR stores them multiplied by alpha.
TEST(Image, TexturesOfFloatsAreEncoded) {
  const TempFolder folder;
  ImageF linear(2, 1, 4);
  const float texels[8] = {0.2888f, 0.0637f, 0.01595f, 0.5f, 0, 1, 0.0024f, 1};
  std::copy(texels, texels + 8, linear.texels.begin());
  ASSERT_TRUE(write_exr(folder / "a.exr", linear).ok());
  const auto exr = read_texture(folder / "a.exr");
  ASSERT_TRUE(exr.ok()) << exr.status().message();
  EXPECT_EQ(exr->image.texels, (std::vector<std::uint8_t>{200, 100, 50, 128, 0, 255, 8, 255}));
  EXPECT_FALSE(exr->clipped);
  // Radiance's texel of four bytes stands for (0.5, 0.25, 0.125).
  const std::string head = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 1\n";
  const auto hdr = read_texture(folder.write("a.hdr", head + "\x80\x40\x20\x80"));
  ASSERT_TRUE(hdr.ok()) << hdr.status().message();
  EXPECT_EQ(hdr->image.texels, (std::vector<std::uint8_t>{188, 137, 99}));
  EXPECT_FALSE(hdr->clipped);
  const auto bright = read_texture(folder.write("b.hdr", head + "\x80\x40\x20\x84"));
  EXPECT_EQ(bright->image.texels, (std::vector<std::uint8_t>{255, 255, 255}));
  EXPECT_TRUE(bright->clipped);
  // What rounding leaves beyond 0 and 1 is not worth a word; what is no number is.
  linear.texels.assign(8, -1e-6f);
  linear.texels[0] = 1.001f;
  ASSERT_TRUE(write_exr(folder / "a.exr", linear).ok());
  EXPECT_FALSE(read_texture(folder / "a.exr")->clipped);
  linear.texels[1] = std::nanf("");
  ASSERT_TRUE(write_exr(folder / "a.exr", linear).ok());
  EXPECT_TRUE(read_texture(folder / "a.exr")->clipped);
}

TEST(Image, TexturesOfIntegersAreReadAsTheyAre) {
  const TempFolder folder;
  const Image8 image = noise(9, 7, 4);
  ASSERT_TRUE(write_png(folder / "a.png", image, {}).ok());
  EXPECT_EQ(read_texture(folder / "a.png")->image.texels, image.texels);
  EXPECT_EQ(read_texture(folder / "gone.png").status().code(), ErrorCode::not_found);
  EXPECT_FALSE(read_texture(folder.write("broken.exr", "no image at all")).ok());
}

// Two names of a file that a program may ask for although they name another format, or none.
TEST(Image, FilesAreOfTheirFormatWhateverTheyAreCalled) {
  const TempFolder folder;
  const Image8 image = noise(9, 7, 3);
  ImageF linear(2, 2, 5);
  for (std::size_t i = 0; i < linear.texels.size(); ++i) linear.texels[i] = float(i);
  for (const char* name : {"page.jpg", "page"}) {
    ASSERT_TRUE(write_png(folder / name, image, {}).ok()) << name;
    const std::string png = TempFolder::read(folder / name);
    EXPECT_EQ(png.substr(0, 4), "\x89PNG") << name;
    const std::vector<std::uint8_t> bytes(png.begin(), png.end());
    EXPECT_EQ(decode_image8(bytes, name)->texels, image.texels) << name;
    const Status status = write_exr(folder / name, linear);
    ASSERT_TRUE(status.ok()) << status.message();
    EXPECT_EQ(TempFolder::read(folder / name).substr(0, 4), "\x76\x2f\x31\x01") << name;
  }
  ASSERT_TRUE(write_exr(folder / "a.exr", linear).ok());
  EXPECT_EQ(read_image_float(folder / "a.exr")->texels, linear.texels);
}

// One texel in the lossless form.
TEST(Image, DecodesWebp) {
  const std::string file(
      "RIFF\x1a\0\0\0WEBPVP8L\x0d\0\0\0\x2f\0\0\0\x10\7\x10\x11\x11\x88\x88\xfe\7\0", 34);
  const auto decoded = decode_image8(std::vector<std::uint8_t>(file.begin(), file.end()), "a");
  ASSERT_TRUE(decoded.ok()) << decoded.status().message();
  EXPECT_EQ(decoded->width, 1);
  EXPECT_EQ(decoded->height, 1);
}

TEST(Image, DecodesFromMemory) {
  const TempFolder folder;
  const Image8 image = noise(9, 7, 3);
  ASSERT_TRUE(write_png(folder / "a.png", image, {}).ok());
  const std::string file = TempFolder::read(folder / "a.png");
  const std::vector<std::uint8_t> bytes(file.begin(), file.end());
  const auto decoded = decode_image8(bytes, "embedded");
  ASSERT_TRUE(decoded.ok()) << decoded.status().message();
  EXPECT_EQ(decoded->texels, image.texels);
  const test::IgnoreLeaks reader;  // libpng leaves OpenImageIO's functions by longjmp
  for (const std::size_t cut :
       {std::size_t{0}, std::size_t{3}, std::size_t{20}, bytes.size() / 2}) {
    const auto damaged = decode_image8(std::span(bytes).first(cut), "scene.glb: image 4");
    ASSERT_FALSE(damaged.ok()) << cut;
    EXPECT_NE(damaged.status().message().find("scene.glb: image 4"), std::string::npos);
  }
}

TEST(Image, ExrKeepsLinearValuesBeyondOne) {
  const TempFolder folder;
  ImageF image(3, 2, 3);
  for (std::size_t i = 0; i < image.texels.size(); ++i) {
    image.texels[i] = 0.1f * float(i * i * i) + 0.001f;
  }
  ASSERT_TRUE(write_exr(folder / "a.exr", image).ok());
  const auto read = read_image_float(folder / "a.exr");
  ASSERT_TRUE(read.ok()) << read.status().message();
  ASSERT_EQ(read->texels.size(), image.texels.size());
  for (std::size_t i = 0; i < image.texels.size(); ++i) {
    EXPECT_NEAR(read->texels[i] / image.texels[i], 1, 1.0 / 2048) << i;  // half floats
  }
}

// The largest half float is 65504, and below 6e-5 half floats lose one digit after another.
TEST(Image, ExrKeepsSunlightAndDimScenes) {
  const TempFolder folder;
  for (const float largest : {65504.0f, 65536.0f, 110000.0f, 1e30f, 0.01f, 1e-3f, 1e-6f, 1e-30f}) {
    ImageF image(4, 1, 1);
    for (const float sign : {1.0f, -1.0f}) {
      for (std::size_t i = 0; i < 4; ++i)
        image.texels[i] = sign * largest * (1 - 0.2999f * float(i));
      ASSERT_TRUE(write_exr(folder / "a.exr", image).ok());
      const auto read = read_image_float(folder / "a.exr");
      ASSERT_TRUE(read.ok()) << read.status().message();
      for (std::size_t i = 0; i < 4; ++i)
        EXPECT_NEAR(read->texels[i] / image.texels[i], 1, 1.0 / 1024) << largest << ' ' << i;
    }
  }
}

TEST(Image, ExrDoesNotHoldTheTimeOfWriting) {
  const TempFolder folder;
  ASSERT_TRUE(write_exr(folder / "a.exr", ImageF(2, 2, 3)).ok());
  const std::string bytes = TempFolder::read(folder / "a.exr");
  const std::size_t date = bytes.find("capDate");
  if (date != bytes.npos) {
    EXPECT_NE(bytes.find("1970:01:01 00:00:00", date), bytes.npos);
  }
}

TEST(Image, FailuresNameTheFile) {
  const TempFolder folder;
  EXPECT_EQ(read_image8(folder / "gone.png").status().code(), ErrorCode::not_found);
  const auto broken = read_image8(folder.write("broken.png", "no image at all"));
  EXPECT_EQ(broken.status().code(), ErrorCode::io);
  EXPECT_NE(broken.status().message().find("broken.png"), std::string::npos);
  ASSERT_TRUE(write_png(folder / "whole.png", noise(64, 64, 3), {}).ok());
  const std::string file = TempFolder::read(folder / "whole.png");
  const test::IgnoreLeaks reader;  // as above
  EXPECT_FALSE(read_image8(folder.write("cut.png", file.substr(0, file.size() / 2))).ok());
  EXPECT_FALSE(read_image8(folder.path()).ok());
  EXPECT_EQ(write_png(folder / "no/folder/a.png", noise(2, 2, 3), {}).code(), ErrorCode::io);
  EXPECT_EQ(write_exr(folder / "no/folder/a.exr", ImageF(2, 2, 3)).code(), ErrorCode::io);
}

TEST(Image, AFullDiskIsNoticed) {
  const TempFolder folder;
  const Image8 image = noise(200, 200, 3);
  const test::IgnoreLeaks writer;  // as above
  const test::FullDisk full(1000);
  ImageF floats(200, 200, 3);
  for (std::size_t i = 0; i < floats.texels.size(); ++i) floats.texels[i] = image.texels[i];
  for (const Status& s :
       {write_png(folder / "a.png", image, {}), write_exr(folder / "a.exr", floats)}) {
    EXPECT_EQ(s.code(), ErrorCode::io);
    EXPECT_NE(s.message().find(": writing failed: File too large (make room there"),
              std::string::npos)
        << s.message();
  }
}

}  // namespace
}  // namespace atlas
