// What the programs ask of the files they write, before long work.
#pragma once

#include <filesystem>
#include <initializer_list>
#include <string>

#include "libatlas/core/context.h"
#include "libatlas/core/status.h"

namespace atlas::app {

// Whether `output` can be written and is none of `others`: the files that are read, and other
// outputs. Empty paths are no files. Errors: io, bad_option.
Status check_output(const std::filesystem::path& output,
                    std::initializer_list<std::filesystem::path> others);

// The whole of a file or of a pipe, whose writer may take its time until the context is cancelled.
// Up to 1 GiB. Errors: not_found, io, bad_input, cancelled.
Result<std::string> read_text(const std::filesystem::path& path, const Context& context);

}  // namespace atlas::app
