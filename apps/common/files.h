// Checks of the files that the programs write, before long work, files of earlier runs, and the
// reading of text files.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "libatlas/core/context.h"
#include "libatlas/core/status.h"

namespace atlas::app {

// Checks that `output` can be written and is none of `others`: the files that are read, and other
// outputs. Empty paths are ignored. Errors: io, bad_option.
Status check_output(const std::filesystem::path& output,
                    const std::vector<std::filesystem::path>& others);

// Reads a whole file or pipe of up to 1 GiB; the writer of a pipe may take its time until the
// context is cancelled. Errors: not_found, io, bad_input, cancelled.
Result<std::string> read_text(const std::filesystem::path& path, const Context& context);

// Returns those of the files name(first), name(first + 1), ... that exist, up to the first that
// does not.
std::vector<std::filesystem::path> files_there(
    std::size_t first, const std::function<std::filesystem::path(std::size_t)>& name);

// Returns the line that tells users which pages an earlier run to the same name has left: they are
// no part of `whole` ("this world"). `pages` are named in order, at least one; `run` says which run
// they are of ("export with more pages").
std::string old_pages_text(std::span<const std::filesystem::path> pages, std::string_view run,
                           std::string_view whole);

}  // namespace atlas::app
