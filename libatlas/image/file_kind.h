// Internal: what kind of image file some bytes are, told by how they begin.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <string_view>

namespace atlas {

// ".png" or ".jpg", the kinds that every program knows; empty for all others.
inline std::string_view image_extension(std::span<const std::uint8_t> bytes) {
  constexpr std::uint8_t kPng[] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
  constexpr std::uint8_t kJpeg[] = {0xff, 0xd8, 0xff};
  const auto begins = [&](std::span<const std::uint8_t> mark) {
    return bytes.size() > mark.size() && std::equal(mark.begin(), mark.end(), bytes.begin());
  };
  return begins(kPng) ? ".png" : begins(kJpeg) ? ".jpg" : "";
}

}  // namespace atlas
