// Internal: replaces several files so that either all of them are new or all are as before, even if
// the process is killed on the way.
//
// A journal, a hidden file in the folder of the first target, says what is being replaced, and the
// earlier files stay under other names until all new ones are in place. Whoever opens the journal
// of a process that was killed puts back what that process had replaced. Between the two, readers
// may find some files new and some old. The journal is locked while its process lives, so commits
// into one folder come one after the other.
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "libatlas/core/status.h"

namespace atlas {

struct Replacement {
  std::filesystem::path temporary;  // the new file
  std::filesystem::path target;     // its name; no symbolic link
  std::filesystem::path before;     // a free name in the target's folder, for the earlier file
  std::string name;                 // the target in messages
};

// Renames every temporary file to its target, in this order. If that fails, what was replaced comes
// back. With `durable`, all that is needed is on the disk before the call returns. Errors: io.
Status replace_files(std::span<const Replacement> files, bool durable);

// Puts back what a killed replace_files() of the same user has replaced, if its first target was in
// `folder`. Errors: io.
Status undo_interrupted(const std::filesystem::path& folder);

}  // namespace atlas
