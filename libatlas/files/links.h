// Internal: where symbolic links lead.
#pragma once

#include <filesystem>

namespace atlas {

// Returns whether symbolic links lead back to themselves, or are more than the system follows.
bool links_have_no_end(const std::filesystem::path& path);

// Returns the path that a symbolic link leads to, over further links if there are any. No file need
// be there yet. Returns `path` itself if it is no link, or if its links have no end.
std::filesystem::path end_of_links(const std::filesystem::path& path);

}  // namespace atlas
