// Output files that are either whole or absent, however the process ends: each is written under a
// temporary name beside its target, and renamed on commit or removed otherwise. If the process is
// killed between two renames, the next AtomicFiles in that folder puts back what was replaced.
// After a power failure or a crash of the machine, the file system determines what is left, unless
// the commit is durable: by default the library does not wait for the disk (no fsync), which would
// take about 4 milliseconds per file.
#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

#include "libatlas/core/status.h"

namespace atlas {

// Collects the files of one export. path_for() returns the path to write each file to; commit()
// renames them all to their targets, in the order of the path_for() calls; the destructor removes
// the files that were not committed. An object is for one thread. Others, also of other processes,
// may write to the same targets meanwhile: the last commit wins with all of its files.
class AtomicFiles {
 public:
  AtomicFiles() = default;
  ~AtomicFiles();
  AtomicFiles(const AtomicFiles&) = delete;
  AtomicFiles& operator=(const AtomicFiles&) = delete;

  // Returns the temporary path to which `target` is to be written. It keeps the extension, since
  // some writers choose the format by it. Symbolic links are followed: the file that they lead to
  // is replaced or created, and they stay. If a file cannot replace the target (a device, a pipe),
  // the target itself is returned and so written directly. Also puts back what killed processes
  // have replaced in the target's folder, and removes the temporary files that they have left.
  std::filesystem::path path_for(const std::filesystem::path& target);

  // Writes `bytes` to the temporary file of `target`. Errors: io; the message names the target.
  Status write(const std::filesystem::path& target, std::string_view bytes);

  // Returns `status` with the temporary names in its message replaced by those of the targets.
  Status told_by_target(const Status& status) const;

  // Removes the file at this temporary path; commit() will not put it in place.
  void discard(const std::filesystem::path& temporary);

  // Returns the targets that commit() will put in place, in the order of the path_for() calls.
  std::vector<std::filesystem::path> targets() const;

  // Renames every file to its target. On failure, the targets that this call had already replaced
  // get their previous files back, and the destructor removes the other temporary files. With
  // `durable`, the disk holds files and folders before the call returns. Errors: io.
  Status commit(bool durable = false);

 private:
  struct Entry {
    std::filesystem::path temporary, target, name;  // name: the target as the caller gave it
  };
  std::vector<Entry> entries_;
  Status interrupted_ = {};  // whether what killed processes have replaced was put back
};

// Checks that a file can be written at `target`, or where its links lead: the directory exists and
// takes files, and the name is not too long. To be called before long work, so that the work is not
// in vain. Errors: io; the message names the directory.
Status check_writable(const std::filesystem::path& target);

// Writes `bytes` to `target` under a temporary name, then renames it.
Status write_file(const std::filesystem::path& target, std::string_view bytes);

}  // namespace atlas
