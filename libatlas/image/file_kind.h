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

}  // namespace atlas
