// Internal: what an image file claims to hold, judged before memory is taken for it. A header of
// thirty bytes can claim ten gigabytes, and most readers believe it.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "libatlas/core/status.h"

namespace atlas {

// An image's decoded size in memory at most: 32768 x 32768 of four 8-bit channels, 16384 x 16384 of
// four floats.
constexpr double kLargestImageBytes = 4.0 * (1 << 30);

struct ImageClaim {
  std::int64_t width = 0, height = 0, channels = 3;
  double channel_bytes = 1;  // in memory
  double packing = 1;        // channel values that one byte of such a file can hold at most
};

// What one byte holds at most in formats that deflate, LZW, run lengths or Huffman codes compress.
// Deflate is the tightest of them: 258 bytes in two bits, and a palette makes four channels of a
// bit.
constexpr double kPackedByte = 1032.0 * 8 * 4;
// In formats that store a plain area in next to nothing.
constexpr double kFlatByte = 1 << 20;

// Whether this is a format for which OpenImageIO takes memory as it opens a file (JPEG, GIF and
// JP2), so that its size has to be found before; by the first 16 bytes.
bool takes_memory_to_open(std::span<const std::uint8_t> head);

// What the first bytes of such a file say, if they reach as far as its size.
std::optional<ImageClaim> claim_of(std::span<const std::uint8_t> head);

// Refuses what is larger than kLargestImageBytes or than a file of so many bytes can hold. Images
// of 64 MiB and less are left to their reader.
Status check_claim(const ImageClaim& claim, std::uint64_t file_bytes, const std::string& name);

}  // namespace atlas
