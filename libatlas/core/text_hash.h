// Internal: a short hash of a text, for names of files.
#pragma once

#include <cstdint>
#include <string_view>

namespace atlas {

// FNV-1a.
inline std::uint32_t text_hash(std::string_view text) {
  std::uint32_t hash = 2166136261u;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 16777619u;
  return hash;
}

}  // namespace atlas
