// What the programs ask of the files they write, before long work.
#pragma once

#include <filesystem>
#include <initializer_list>
#include <string>

#include "libatlas/core/status.h"

namespace atlas::app {

// Whether `output` can be written and is none of `others`: the files that are read, and other
// outputs. Empty paths are no files. Errors: io, bad_option.
Status check_output(const std::filesystem::path& output,
                    std::initializer_list<std::filesystem::path> others);

// The extension in small letters, however the name has it: .CSV is .csv.
std::string lower_extension(const std::filesystem::path& path);

}  // namespace atlas::app
