#include "libatlas/image/webp.h"

#include <fmt/format.h>
#include <webp/decode.h>
#include <webp/encode.h>

#include <algorithm>
#include <cstddef>

namespace atlas {
namespace {

// Effort of lossless files: 0 (fast) to 9. Higher levels take several times as long for baked
// pages, and save a few percent.
constexpr int kLosslessEffort = 3;

// Returns RGB or RGBA, row 0 at the top.
std::vector<std::uint8_t> top_down(const Image8& image) {
  const bool grey = image.channels < 3, alpha = image.channels % 2 == 0;
  std::vector<std::uint8_t> out;
  out.reserve(std::size_t(image.width) * std::size_t(image.height) * (alpha ? 4 : 3));
  for (int y = image.height - 1; y >= 0; --y)
    for (int x = 0; x < image.width; ++x) {
      const std::uint8_t* from = image.at(x, y);
      for (int k = 0; k < 3; ++k) out.push_back(from[grey ? 0 : k]);
      if (alpha) out.push_back(from[image.channels - 1]);
    }
  return out;
}

// A picture and the file that it becomes, which libwebp allocates.
class Encoding {
 public:
  Encoding() : started_(WebPPictureInit(&picture_) != 0) {
    WebPMemoryWriterInit(&file_);
    picture_.writer = WebPMemoryWrite;
    picture_.custom_ptr = &file_;
  }
  ~Encoding() {
    WebPPictureFree(&picture_);
    WebPMemoryWriterClear(&file_);
  }
  Encoding(const Encoding&) = delete;
  Encoding& operator=(const Encoding&) = delete;

  bool run(const Image8& image, const WebPConfig& config) {
    if (!started_) return false;
    picture_.width = image.width;
    picture_.height = image.height;
    picture_.use_argb = 1;
    const std::vector<std::uint8_t> texels = top_down(image);
    const bool alpha = image.channels % 2 == 0;
    const int row = image.width * (alpha ? 4 : 3);
    return (alpha ? WebPPictureImportRGBA(&picture_, texels.data(), row)
                  : WebPPictureImportRGB(&picture_, texels.data(), row)) &&
           WebPEncode(&config, &picture_);
  }
  std::vector<std::uint8_t> bytes() const { return {file_.mem, file_.mem + file_.size}; }
  int error() const { return picture_.error_code; }

 private:
  WebPPicture picture_ = {};
  WebPMemoryWriter file_ = {};
  bool started_;
};

}  // namespace

Result<std::vector<std::uint8_t>> encode_webp(const Image8& image, const WebpOptions& options) {
  if (options.quality < 0 || options.quality > 100)
    return Status(ErrorCode::bad_option,
                  fmt::format("WebpOptions::quality is {}; it must be within "
                              "1..100, or 0 for lossless",
                              options.quality));
  if (image.empty() || image.channels > 4 || !image.whole() || image.width > kLongestWebpSide ||
      image.height > kLongestWebpSide)
    return Status(ErrorCode::bad_input,
                  fmt::format("an image of {} x {} texels and {} channels is none that WebP holds "
                              "(sides of 1 to {}, 1 to 4 channels)",
                              image.width, image.height, image.channels, kLongestWebpSide));
  WebPConfig config;
  if (!WebPConfigInit(&config))
    return Status(ErrorCode::unsupported, "libwebp is of another version");
  if (options.quality == 0) {
    WebPConfigLosslessPreset(&config, kLosslessEffort);
    config.exact = 1;  // colours stay where alpha is 0
  } else {
    config.quality = float(options.quality);
    config.use_sharp_yuv = 1;  // charts of different colours lie side by side
    // Pages are seen from all distances, lit and turned as the surface is. What spares bytes where
    // a photograph's viewer would look less closely costs a seventh of them for the same decibels.
    config.sns_strength = 0;
    config.filter_strength = 0;
  }
  Encoding encoding;
  if (!encoding.run(image, config))
    return Status(ErrorCode::bad_input, fmt::format("an image of {} x {} texels cannot be encoded "
                                                    "as WebP (error {} of libwebp)",
                                                    image.width, image.height, encoding.error()));
  return encoding.bytes();
}

Result<Image8> decode_webp(std::span<const std::uint8_t> bytes, const std::string& name) {
  const auto damaged = [&] {
    return Status(ErrorCode::io, name + ": is no WebP image, is animated, or is damaged");
  };
  WebPBitstreamFeatures features;
  if (WebPGetFeatures(bytes.data(), bytes.size(), &features) != VP8_STATUS_OK ||
      features.has_animation)
    return damaged();
  Image8 image(features.width, features.height, features.has_alpha ? 4 : 3);
  const int row = image.width * image.channels;
  const auto* decoded = features.has_alpha
                            ? WebPDecodeRGBAInto(bytes.data(), bytes.size(), image.texels.data(),
                                                 image.texels.size(), row)
                            : WebPDecodeRGBInto(bytes.data(), bytes.size(), image.texels.data(),
                                                image.texels.size(), row);
  if (!decoded) return damaged();
  for (int y = 0; y < image.height / 2; ++y)
    std::swap_ranges(image.at(0, y), image.at(0, y) + row, image.at(0, image.height - 1 - y));
  return image;
}

}  // namespace atlas
