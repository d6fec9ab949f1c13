// Replaces the option fields in the library's messages by the program's flags, which its users
// know.
#pragma once

#include <string>
#include <string_view>

namespace atlas::app {

// Returns the text with every field that has a flag replaced by the flag (--atlas-size for
// ExportOptions::atlas_size).
std::string with_flag_names(std::string_view text);

}  // namespace atlas::app
