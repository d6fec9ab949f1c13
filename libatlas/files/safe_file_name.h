// Names of files that every viewer can load.
#pragma once

#include <filesystem>
#include <string>

namespace atlas {

// Returns a file name of letters, digits, '_', '-' and '.' only, which all viewers can load, made
// from any text. Texts with other characters almost always get different names.
std::string safe_file_name(const std::string& text);

// Returns the path of a file in the folder of `path`, whose name is safe_file_name() of that of
// `path`, with this extension (".mtl") in place of its own.
std::filesystem::path safely_beside(const std::filesystem::path& path, const char* extension);

}  // namespace atlas
