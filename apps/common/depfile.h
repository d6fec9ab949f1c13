// Dependency files, which tell make and ninja what an output was made from.
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "libatlas/core/status.h"

namespace atlas::app {

// Returns a rule `target: inputs` as compilers write it with -MD: spaces, '#', '$' and ':' of names
// are escaped as GNU make and ninja read them. Empty inputs, and those that are named again, are
// left out. Errors: bad_option for a name that the two cannot read.
Result<std::string> dependency_rule(const std::filesystem::path& target,
                                    std::span<const std::filesystem::path> inputs);

}  // namespace atlas::app
