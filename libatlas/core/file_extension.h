// The part of a file's name that chooses its format.
#pragma once

#include <filesystem>
#include <string>

namespace atlas {

// ".obj" of "scene.OBJ": in small letters, however the name has it, whatever the locale; empty
// where there is none.
inline std::string lower_extension(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  for (char& c : extension) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return extension;
}

}  // namespace atlas
