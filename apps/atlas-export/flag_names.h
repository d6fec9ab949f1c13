// The library's messages name fields of its option structs; users of the program know its flags.
#pragma once

#include <string>
#include <string_view>

namespace atlas::app {

// The text with the flag in place of every field that has one (--atlas-size for
// ExportOptions::atlas_size).
std::string with_flag_names(std::string_view text);

}  // namespace atlas::app
