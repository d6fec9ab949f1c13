// Output files that are either whole or absent, however the process ends: written under a temporary
// name beside the target, renamed on commit, removed otherwise. What the machine leaves that loses
// its power or stops working is up to its file system: nothing waits for the disk, which would take
// some 4 milliseconds a file.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string_view>
#include <vector>

#include "libatlas/core/status.h"

namespace atlas {

// Collects the files of one export. Ask path_for() where to write each; commit() renames them all
// into place in the order they were asked for; the destructor removes what was not committed. Used
// by one thread; others may write to the same targets meanwhile: whoever commits last wins.
class AtomicFiles {
 public:
  AtomicFiles() = default;
  ~AtomicFiles();
  AtomicFiles(const AtomicFiles&) = delete;
  AtomicFiles& operator=(const AtomicFiles&) = delete;

  // The temporary path to write `target` under. It keeps the extension, since image writers choose
  // the format by it. Links are followed: what they lead to is replaced, not they themselves. What
  // cannot be replaced by a file (a device, a pipe) is written to at once. Temporary files that
  // processes ended by force have left in the target's folder are removed.
  std::filesystem::path path_for(const std::filesystem::path& target);

  // Writes `bytes` to what will be `target`. Errors: io, naming the target.
  Status write(const std::filesystem::path& target, std::string_view bytes);

  // The same status with targets where its message says temporary names.
  Status told_by_target(const Status& status) const;

  // Removes what was written under this temporary path; commit() will not put it in place.
  void discard(const std::filesystem::path& temporary);

  // What commit() will put in place, in the order asked for.
  std::vector<std::filesystem::path> targets() const;

  // Renames every file to its target. On failure no temporary name is left, and what this call had
  // already replaced stands there again (on file systems with hard links; on others it is gone).
  Status commit();

 private:
  struct Entry {
    std::filesystem::path temporary, target, name;  // name: the target as it was asked for
    std::filesystem::path before = {};  // a second name of what stood at the target, or empty
  };
  static Status put_in_place(Entry& entry);
  static void take_back(Entry& entry);
  std::vector<Entry> entries_;
};

// Whether a file could be written at `target`: its directory exists and takes files, its name is
// none too long. Ask before long work, so that it does not end in vain. Error: io, naming the
// directory.
Status check_writable(const std::filesystem::path& target);

// Writes `bytes` to `target` under a temporary name, then renames it.
Status write_file(const std::filesystem::path& target, std::string_view bytes);

}  // namespace atlas
