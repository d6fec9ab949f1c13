// WebP files in memory (Google's VP8 and VP8L bitstreams in a RIFF container). Rows are bottom-up
// in memory (core/image.h), and their order is reversed here.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "libatlas/core/image.h"
#include "libatlas/core/status.h"

namespace atlas {

// The longest side of a WebP image, texels.
constexpr int kLongestWebpSide = 16383;

struct WebpOptions {
  // 1 (smallest) to 100 (finest): lossy, with colours at half resolution. 0: lossless.
  int quality = 0;
};

// Encodes an image of 1 to 4 channels; grey ones become RGB, of which colours keep their values
// beside any alpha. The bytes depend on nothing but the arguments and the version of libwebp.
// Errors: bad_option (the quality), bad_input (a side of 0 or beyond kLongestWebpSide; the image is
// not as large as its sides say).
Result<std::vector<std::uint8_t>> encode_webp(const Image8& image, const WebpOptions& options);

// Decodes an image to 3 channels, or to 4 if it has alpha, by which colours are not multiplied.
// `name` is for messages. Errors: io (no WebP image, animated, or damaged).
Result<Image8> decode_webp(std::span<const std::uint8_t> bytes, const std::string& name);

}  // namespace atlas
