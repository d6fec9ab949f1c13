// Internal: recognises the format of an image file by its first bytes.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <string_view>

namespace atlas {

inline bool begins_with(std::span<const std::uint8_t> bytes, std::string_view signature) {
  return bytes.size() >= signature.size() &&
         std::equal(signature.begin(), signature.end(), bytes.begin(),
                    [](char a, std::uint8_t b) { return std::uint8_t(a) == b; });
}

// Returns ".png" or ".jpg", the formats that every program reads; empty for all other formats.
inline std::string_view image_extension(std::span<const std::uint8_t> bytes) {
  if (begins_with(bytes, "\x89PNG\r\n\x1a\n")) return ".png";
  return begins_with(bytes, "\xff\xd8\xff") ? ".jpg" : "";
}

// A format that glTF holds only by an extension, by the names that it has there.
struct ExtensionFormat {
  std::string_view extension, mime_type;  // both empty: the format is none of these
};

// Recognises WebP (EXT_texture_webp), KTX 2 (KHR_texture_basisu), KTX (KHR_texture_ktx), DDS
// (MSFT_texture_dds) and AVIF (EXT_texture_avif).
inline ExtensionFormat extension_format(std::span<const std::uint8_t> bytes) {
  constexpr std::size_t kBrand = 8;
  const auto after = bytes.subspan(std::min(bytes.size(), kBrand));
  const auto before = bytes.subspan(std::min<std::size_t>(bytes.size(), 4));
  if (begins_with(bytes, "RIFF") && begins_with(after, "WEBP")) return {".webp", "image/webp"};
  if (begins_with(bytes, "\xabKTX 20\xbb")) return {".ktx2", "image/ktx2"};
  if (begins_with(bytes, "\xabKTX 11\xbb")) return {".ktx", "image/ktx"};
  if (begins_with(bytes, "DDS ")) return {".dds", "image/vnd-ms.dds"};
  if (begins_with(before, "ftyp") && (begins_with(after, "avif") || begins_with(after, "avis")))
    return {".avif", "image/avif"};
  return {};
}

}  // namespace atlas
