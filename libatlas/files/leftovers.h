// Internal: finds and removes the temporary files that killed processes have left.
#pragma once

#include <filesystem>
#include <string>

namespace atlas {

// Returns the mark that this process puts into the names of its temporary files, for example
// "5ab81c07-1234". The first part identifies the machine's boot and the process namespace
// (container) that the process runs in; the second is its process number there.
std::string process_mark();

// Removes the files of `folder` whose names contain ".MARK.part", where MARK is the mark of a
// process that has ended. Files of another boot or namespace stay, because it is not possible to
// find out whether their processes have ended.
void remove_leftovers(const std::filesystem::path& folder);

}  // namespace atlas
