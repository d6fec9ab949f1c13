#include "libatlas/image/webp.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "libatlas/image/image_io.h"

namespace atlas {
namespace {

// A smooth image with an edge, as baked pages have, and of no symmetry.
Image8 page(int width, int height, int channels) {
  Image8 image(width, height, channels);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (int k = 0; k < channels; ++k)
        image.at(x, y)[k] = std::uint8_t((x > width / 3 ? 40 : 90) + y * (k + 1) / 2 + x / 3);
  return image;
}

double decibels(const Image8& a, const Image8& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.texels.size(); ++i) sum += std::pow(a.texels[i] - b.texels[i], 2);
  return 10 * std::log10(255.0 * 255.0 * double(a.texels.size()) / sum);
}

TEST(Webp, LosslessFilesKeepEveryTexel) {
  for (const int channels : {3, 4}) {
    const Image8 image = page(37, 51, channels);
    const auto bytes = encode_webp(image, {});
    ASSERT_TRUE(bytes.ok()) << bytes.status().message();
    const auto again = decode_webp(*bytes, "page.webp");
    ASSERT_TRUE(again.ok()) << again.status().message();
    EXPECT_EQ(again->width, 37);
    EXPECT_EQ(again->channels, channels);
    EXPECT_EQ(again->texels, image.texels);
    // As the reader of all formats decodes it.
    const auto read = decode_image8(*bytes, "page.webp");
    ASSERT_TRUE(read.ok()) << read.status().message();
    EXPECT_EQ(read->texels, image.texels);
  }
}

TEST(Webp, GreyBecomesColours) {
  const auto bytes = encode_webp(page(8, 8, 1), {});
  ASSERT_TRUE(bytes.ok());
  const auto again = decode_webp(*bytes, "grey.webp");
  ASSERT_TRUE(again.ok());
  EXPECT_EQ(again->channels, 3);
  EXPECT_EQ(again->at(7, 2)[1], page(8, 8, 1).at(7, 2)[0]);
}

TEST(Webp, QualityTradesBytesForDecibels) {
  const Image8 image = page(200, 160, 3);
  std::size_t last_bytes = 0;
  double last = 29;
  for (const int quality : {20, 70, 95}) {
    const auto bytes = encode_webp(image, {quality});
    ASSERT_TRUE(bytes.ok());
    const auto again = decode_webp(*bytes, "page.webp");
    ASSERT_TRUE(again.ok());
    EXPECT_GT(bytes->size(), last_bytes) << quality;
    EXPECT_GT(decibels(image, *again), last) << quality;
    last_bytes = bytes->size();
    last = decibels(image, *again);
  }
}

TEST(Webp, RefusesWhatItCannotHold) {
  EXPECT_EQ(encode_webp(page(4, 4, 3), {101}).status().code(), ErrorCode::bad_option);
  EXPECT_EQ(encode_webp(page(4, 4, 3), {-1}).status().code(), ErrorCode::bad_option);
  EXPECT_EQ(encode_webp(Image8(), {}).status().code(), ErrorCode::bad_input);
  EXPECT_EQ(encode_webp(Image8(kLongestWebpSide + 1, 1, 3), {}).status().code(),
            ErrorCode::bad_input);
}

TEST(Webp, DamagedFilesAreToldByName) {
  auto bytes = *encode_webp(page(64, 64, 3), {});
  bytes.resize(bytes.size() / 2);
  for (const auto& wrong : {bytes, std::vector<std::uint8_t>{}, std::vector<std::uint8_t>(40, 7)}) {
    const auto read = decode_webp(wrong, "broken.webp");
    ASSERT_FALSE(read.ok());
    EXPECT_EQ(read.status().code(), ErrorCode::io);
    EXPECT_NE(read.status().message().find("broken.webp"), std::string::npos);
  }
}

}  // namespace
}  // namespace atlas
