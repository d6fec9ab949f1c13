// Internal: temporary files that a process left when it was ended by force.
#pragma once

#include <filesystem>
#include <string>

namespace atlas {

// What this process puts into the names of its temporary files, "5ab81c07-1234": in which world of
// processes it runs (this start of this machine, this container), and its number there.
std::string process_mark();

// Removes the files of `folder` whose names hold ".MARK.part" or ".MARK.before" where MARK is that
// of a process that has ended. Those of another world, whose processes cannot be asked for, stay.
void remove_leftovers(const std::filesystem::path& folder);

}  // namespace atlas
