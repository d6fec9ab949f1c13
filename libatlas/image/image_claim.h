// Internal: the size that an image file claims to have, which is checked before memory is allocated
// for it. A header of thirty bytes can claim ten gigabytes, and most readers believe it.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "libatlas/core/status.h"

namespace atlas {

// The largest decoded size of an image in memory, in bytes: 32768 x 32768 texels of four 8-bit
// channels, or 16384 x 16384 of four floats.
constexpr double kLargestImageBytes = 4.0 * (1 << 30);

struct ImageClaim {
  std::int64_t width = 0, height = 0, channels = 3;
  double channel_bytes = 1;  // bytes per channel value in memory
  double packing = 1;        // most channel values that one byte of such a file can hold
};

// The most channel values that one byte of a file can hold, in formats with Deflate, LZW,
// run-length or Huffman compression. Deflate has the highest bound: it stores 258 bytes in two
// bits, and a palette makes four channels of one bit.
constexpr double kPackedByte = 1032.0 * 8 * 4;
// The same in formats that store an area of one colour in almost no space.
constexpr double kFlatByte = 1 << 20;

// Returns whether OpenImageIO allocates memory already when it opens a file of this format: the
// image's (GIF and JPEG-2000) or that of attributes (OpenEXR). What the file claims must be
// found before. `head` holds the first 64 bytes of the file.
bool takes_memory_to_open(std::span<const std::uint8_t> head);

// Returns the size that such a file claims, or nothing if `head`, its first bytes, ends before it.
std::optional<ImageClaim> claim_of(std::span<const std::uint8_t> head);

// Returns whether a BMP file states runs of palette entries, but has colours instead of a palette.
// OpenImageIO 2.4 reads outside its memory then. `head` holds the first 64 bytes of the file.
bool bmp_lacks_palette(std::span<const std::uint8_t> head);

// Returns whether an attribute in the header of an OpenEXR file claims more bytes than follow in
// the file, for which OpenEXR takes memory, up to 2 GiB. `head` holds the beginning of the file.
bool exr_overclaims(std::span<const std::uint8_t> head, std::uint64_t file_bytes);

// Refuses images that claim to be larger than kLargestImageBytes (unsupported), and those that
// claim more than 64 MiB and more than a file of `file_bytes` can hold, or a side or channel count
// below 1 (bad_input). `name` is for the message.
Status check_claim(const ImageClaim& claim, std::uint64_t file_bytes, const std::string& name);

}  // namespace atlas
