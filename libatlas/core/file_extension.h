// The part of a file's name that chooses its format.
#pragma once

#include <filesystem>
#include <string>

#include "libatlas/core/small_letters.h"

namespace atlas {

// ".obj" of "scene.OBJ": in small letters, however the name has it, whatever the locale; empty
// where there is none.
inline std::string lower_extension(const std::filesystem::path& path) {
  return small_letters(path.extension().string());
}

}  // namespace atlas
