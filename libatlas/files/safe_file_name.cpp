#include "libatlas/files/safe_file_name.h"

#include <fmt/format.h>

#include <cstdint>

#include "libatlas/core/text_hash.h"

namespace atlas {

std::string safe_file_name(const std::string& text) {
  std::string name = text;
  for (char& c : name) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                       c == '-' || c == '_' || (c == '.' && &c != name.data());
    if (!plain) c = '_';
  }
  if (name.empty()) return "world";
  if (name == text) return name;
  // Without the hash, names in another script would all become the same row of '_'.
  const std::uint32_t hash = text_hash(text);
  return fmt::format("{}-{:04x}", name, (hash ^ (hash >> 16)) & 0xffff);
}

std::filesystem::path safely_beside(const std::filesystem::path& path, const char* extension) {
  return path.parent_path() / (safe_file_name(path.stem().string()) + extension);
}

}  // namespace atlas
