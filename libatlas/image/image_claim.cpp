#include "libatlas/image/image_claim.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "libatlas/image/file_kind.h"

namespace atlas {
namespace {

using Bytes = std::span<const std::uint8_t>;

// Readers of GIF look at no more of the signature than this.
constexpr std::string_view kGif = "GIF", kCodeStream = "\xff\x4f\xff\x51",
                           kExr = "\x76\x2f\x31\x01";
constexpr double kHarmlessBytes = 64.0 * (1 << 20);

std::int64_t big_endian(Bytes bytes, std::size_t at, int count) {
  std::int64_t value = 0;
  for (int i = 0; i < count; ++i) value = value << 8 | bytes[at + std::size_t(i)];
  return value;
}

std::optional<ImageClaim> gif_claim(Bytes b) {
  if (b.size() < 10) return {};
  return ImageClaim{b[6] | b[7] << 8, b[8] | b[9] << 8, 4, 1, kPackedByte};
}

// Returns whether this is a bare JPEG-2000 code stream, or one in the boxes of a JP2 file.
bool is_jpeg2000(Bytes b) {
  return begins_with(b, kCodeStream) || (b.size() > 8 && begins_with(b.subspan(4), "jP  "));
}

std::optional<ImageClaim> jpeg2000_claim(Bytes b) {
  const auto found = std::search(b.begin(), b.end(), kCodeStream.begin(), kCodeStream.end(),
                                 [](std::uint8_t x, char y) { return x == std::uint8_t(y); });
  const auto at = std::size_t(found - b.begin());
  if (b.size() - at < 42) return {};
  return ImageClaim{big_endian(b, at + 8, 4) - big_endian(b, at + 16, 4),
                    big_endian(b, at + 12, 4) - big_endian(b, at + 20, 4),
                    big_endian(b, at + 40, 2), 1, kFlatByte};
}

std::string size_text(double bytes) {
  constexpr const char* kUnits[] = {"bytes", "KiB", "MiB", "GiB", "TiB"};
  int unit = 0;
  for (; bytes >= 1000 && unit < 4; ++unit) bytes /= 1024;
  return fmt::format("{:.{}f} {}", bytes, unit == 0 || bytes >= 100 ? 0 : 1, kUnits[unit]);
}

}  // namespace

bool takes_memory_to_open(Bytes head) {
  return begins_with(head, kGif) || is_jpeg2000(head) || begins_with(head, kExr);
}

std::optional<ImageClaim> claim_of(Bytes head) {
  if (begins_with(head, kGif)) return gif_claim(head);
  if (is_jpeg2000(head)) return jpeg2000_claim(head);
  return {};
}

// After the file's header of 14 bytes follows another that begins with its own size. In all but the
// oldest, of 12 bytes, byte 14 states the bits of a texel, and byte 16 the compression.
bool bmp_lacks_palette(Bytes head) {
  constexpr std::uint8_t kOldest = 12, kRuns8 = 1, kRuns4 = 2, kMostPaletteBits = 8;
  if (!begins_with(head, "BM") || head.size() < 34 || head[14] == kOldest) return false;
  const std::uint8_t bits = head[28], compression = head[30];
  return (compression == kRuns8 || compression == kRuns4) && bits > kMostPaletteBits;
}

// A header is a list of attributes, each of a name and a type that end in 0, a length of four bytes
// and the value. An empty name ends it; in files of several parts, the next header follows.
bool exr_overclaims(Bytes head, std::uint64_t file_bytes) {
  constexpr std::size_t kFirst = 8, kFlags = 5;
  constexpr std::uint8_t kSeveralParts = 0x10;
  if (!begins_with(head, kExr) || head.size() <= kFirst) return false;
  const bool several = head[kFlags] & kSeveralParts;
  for (std::size_t at = kFirst; at < head.size();) {
    if (head[at] == 0) {
      if (!several || ++at >= head.size() || head[at] == 0) return false;
      continue;
    }
    for (int text = 0; text < 2; ++text) {
      while (at < head.size() && head[at] != 0) ++at;
      ++at;
    }
    if (at + 4 > head.size()) return false;
    std::uint32_t length = 0;
    for (std::size_t k = 0; k < 4; ++k) length |= std::uint32_t{head[at + k]} << (8 * k);
    at += 4;
    if (length > file_bytes - std::min<std::uint64_t>(at, file_bytes)) return true;
    at += length;
  }
  return false;
}

Status check_claim(const ImageClaim& claim, std::uint64_t file_bytes, const std::string& name) {
  const std::string says = fmt::format("{}: claims {} x {} texels of {} channels", name,
                                       claim.width, claim.height, claim.channels);
  if (claim.width < 1 || claim.height < 1 || claim.channels < 1) {
    return {ErrorCode::bad_input, says + ": the file is damaged, save it anew"};
  }
  const double values = double(claim.width) * double(claim.height) * double(claim.channels);
  const double bytes = values * claim.channel_bytes;
  if (bytes > kHarmlessBytes && values > double(file_bytes) * claim.packing) {
    return {
        ErrorCode::bad_input,
        fmt::format("{} ({}), which {} cannot hold: the file is damaged or cut short, save it anew",
                    says, size_text(bytes), size_text(double(file_bytes)))};
  }
  if (bytes > kLargestImageBytes) {
    return {ErrorCode::unsupported,
            fmt::format("{} ({}), and at most {} are read: make the image smaller", says,
                        size_text(bytes), size_text(kLargestImageBytes))};
  }
  return {};
}

}  // namespace atlas
