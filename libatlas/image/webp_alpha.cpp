#include "libatlas/image/webp_alpha.h"

#include <cstddef>

#include "libatlas/image/file_kind.h"

namespace atlas {

// A file is a list of chunks: four letters, the number of bytes that follow, and these bytes,
// padded to an even number. A lossless image (VP8L) holds its alpha among its colours, and one bit
// of its header says whether that is used. A lossy image has its alpha in a chunk of its own
// (ALPH).
std::vector<std::uint8_t> without_webp_alpha(std::span<const std::uint8_t> file) {
  constexpr std::size_t kFileHeader = 12, kChunkHeader = 8, kFrameHeader = 16;
  constexpr std::uint8_t kAlphaFlag = 0x10;  // in both kinds of header
  std::vector<std::uint8_t> copy(file.begin(), file.end());
  if (!begins_with(file, "RIFF")) return copy;
  for (std::size_t at = kFileHeader; at < copy.size() && copy.size() - at > kChunkHeader + 4;) {
    const std::span<const std::uint8_t> chunk = std::span<const std::uint8_t>(copy).subspan(at);
    std::size_t length = 0;
    for (std::size_t k = 0; k < 4; ++k) length |= std::size_t{chunk[4 + k]} << (8 * k);
    if (begins_with(chunk, "VP8X")) copy[at + kChunkHeader] &= std::uint8_t(~kAlphaFlag);
    if (begins_with(chunk, "VP8L")) copy[at + kChunkHeader + 4] &= std::uint8_t(~kAlphaFlag);
    if (begins_with(chunk, "ALPH")) copy[at] = 'a';  // chunks of unknown names are skipped
    // The frames of an animation contain chunks themselves.
    at += kChunkHeader + (begins_with(chunk, "ANMF") ? kFrameHeader : length + length % 2);
  }
  return copy;
}

}  // namespace atlas
