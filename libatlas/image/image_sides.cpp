#include "libatlas/image/image_sides.h"

#include <cstddef>
#include <fstream>
#include <vector>

#include "libatlas/image/file_kind.h"

namespace atlas {
namespace {

using Bytes = std::span<const std::uint8_t>;

// Returns the number in `count` bytes from `at` on, or 0 if they are not there.
std::int64_t little(Bytes b, std::size_t at, std::size_t count) {
  std::int64_t value = 0;
  for (std::size_t i = count; i-- > 0 && at + count <= b.size();) value = value << 8 | b[at + i];
  return value;
}

std::int64_t big(Bytes b, std::size_t at, std::size_t count) {
  std::int64_t value = 0;
  for (std::size_t i = 0; i < count && at + count <= b.size(); ++i) value = value << 8 | b[at + i];
  return value;
}

std::optional<ImageSides> sides(std::int64_t width, std::int64_t height) {
  constexpr std::int64_t kMost = 0x7fffffff;
  if (width < 1 || height < 1 || width > kMost || height > kMost) return {};
  return ImageSides{width, height};
}

// The frame's header follows segments that each state their length.
std::optional<ImageSides> jpeg_sides(Bytes b) {
  for (std::size_t at = 2; at + 9 <= b.size();) {
    const int marker = b[at + 1];
    if (b[at] != 0xff || marker == 0xff) {  // fill bytes, and bytes that decoders skip
      ++at;
      continue;
    }
    const bool other = marker == 0xc4 || marker == 0xc8 || marker == 0xcc;
    if (marker >= 0xc0 && marker <= 0xcf && !other)
      return sides(big(b, at + 7, 2), big(b, at + 5, 2));
    const bool bare = marker <= 1 || (marker >= 0xd0 && marker <= 0xd8);
    at += bare ? 2 : 2 + static_cast<std::size_t>(big(b, at + 2, 2));
  }
  return {};
}

// The chunk after the head of the container is lossy, lossless, or describes what follows.
std::optional<ImageSides> webp_sides(Bytes b) {
  const Bytes chunk = b.subspan(12);
  if (begins_with(chunk, "VP8X")) return sides(1 + little(b, 24, 3), 1 + little(b, 27, 3));
  if (begins_with(chunk, "VP8L")) {
    const std::int64_t bits = little(b, 21, 4);
    return sides(1 + (bits & 0x3fff), 1 + (bits >> 14 & 0x3fff));
  }
  return sides(little(b, 26, 2) & 0x3fff, little(b, 28, 2) & 0x3fff);
}

// The entries of the first directory have 12 bytes: a tag, the type of the value, their count, and
// the value.
std::optional<ImageSides> tiff_sides(Bytes b) {
  constexpr std::int64_t kWidth = 256, kHeight = 257, kShort = 3;
  const auto number = b[0] == 'I' ? little : big;
  const auto directory = static_cast<std::size_t>(number(b, 4, 4));
  std::int64_t width = 0, height = 0;
  for (std::int64_t i = 0; i < number(b, directory, 2); ++i) {
    const std::size_t at = directory + 2 + 12 * static_cast<std::size_t>(i);
    const std::int64_t tag = number(b, at, 2);
    const std::int64_t value = number(b, at + 8, number(b, at + 2, 2) == kShort ? 2 : 4);
    if (tag == kWidth) width = value;
    if (tag == kHeight) height = value;
  }
  return sides(width, height);
}

}  // namespace

std::optional<ImageSides> sides_in_header(Bytes head) {
  if (head.size() < 30) return {};
  if (begins_with(head, "\x89PNG")) return sides(big(head, 16, 4), big(head, 20, 4));
  if (begins_with(head, "\xff\xd8")) return jpeg_sides(head);
  if (begins_with(head, "GIF8")) return sides(little(head, 6, 2), little(head, 8, 2));
  if (begins_with(head, "BM")) {  // rows from the top down have a negative height
    const auto height = static_cast<std::int32_t>(little(head, 22, 4));
    return sides(little(head, 18, 4), height < 0 ? -std::int64_t{height} : height);
  }
  if (begins_with(head, "RIFF") && begins_with(head.subspan(8), "WEBP")) return webp_sides(head);
  if (begins_with(head, "II*") || begins_with(head, "MM")) return tiff_sides(head);
  return {};
}

std::optional<ImageSides> image_sides(const std::filesystem::path& path) {
  std::vector<std::uint8_t> head(std::size_t{1} << 16);
  std::ifstream file(path, std::ios::binary);
  file.read(reinterpret_cast<char*>(head.data()), std::streamsize(head.size()));
  head.resize(static_cast<std::size_t>(file.gcount()));
  return sides_in_header(head);
}

}  // namespace atlas
