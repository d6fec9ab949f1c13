// Checks of the files that the programs write, before long work, and the reading of text files.
#pragma once

#include <filesystem>
#include <initializer_list>
#include <string>

#include "libatlas/core/context.h"
#include "libatlas/core/status.h"

namespace atlas::app {

// Checks that `output` can be written and is none of `others`: the files that are read, and other
// outputs. Empty paths are ignored. Errors: io, bad_option.
Status check_output(const std::filesystem::path& output,
                    std::initializer_list<std::filesystem::path> others);

// Reads a whole file or pipe of up to 1 GiB; the writer of a pipe may take its time until the
// context is cancelled. Errors: not_found, io, bad_input, cancelled.
Result<std::string> read_text(const std::filesystem::path& path, const Context& context);

}  // namespace atlas::app
