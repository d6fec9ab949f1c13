// The extension of a file's name, which determines the format.
#pragma once

#include <filesystem>
#include <string>

#include "libatlas/core/small_letters.h"

namespace atlas {

// Returns the extension in lower case, independent of the locale: ".obj" for "scene.OBJ"; empty if
// there is none.
inline std::string lower_extension(const std::filesystem::path& path) {
  return small_letters(path.extension().string());
}

}  // namespace atlas
