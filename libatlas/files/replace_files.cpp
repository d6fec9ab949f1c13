#include "libatlas/files/replace_files.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string_view>
#include <thread>
#include <vector>

#include "libatlas/files/write_error.h"

namespace atlas {
namespace {

namespace fs = std::filesystem;

Status failure(const std::string& name, std::string_view what, int error) {
  return {ErrorCode::io, fmt::format("{}: {}: {}", name, what, write_error(error))};
}

fs::path folder_of(const fs::path& file) {
  return file.has_parent_path() ? file.parent_path() : fs::path(".");
}

// What tells a file from others of its name. A rename changes neither.
struct Stamp {
  std::int64_t size = 0, seconds = 0, nanoseconds = 0;
  bool operator==(const Stamp&) const = default;
};

// Returns the stamp of a file itself, links not followed, or nothing if there is none.
std::optional<Stamp> stamp_of(const fs::path& file) {
  struct stat found {};
  if (::lstat(file.c_str(), &found) != 0) return {};
  return Stamp{found.st_size, found.st_mtim.tv_sec, found.st_mtim.tv_nsec};
}

bool is_file(const fs::path& path) {
  struct stat found {};
  return ::lstat(path.c_str(), &found) == 0 && S_ISREG(found.st_mode);
}

struct Step {
  fs::path target, before;
  bool replaces = false;  // whether there is an earlier file
  Stamp stamp = {};       // of the new file
};

// Removes the other name of the earlier file. Returns 0 or an errno.
int remove_earlier(const Step& step) {
  if (!step.replaces || ::unlink(step.before.c_str()) == 0 || errno == ENOENT) return 0;
  return errno;
}

// Puts back the earlier file, or removes the new one. Does nothing where that is done, or where the
// target is neither file. Returns 0 or an errno.
int undo(const Step& step) {
  const std::optional<Stamp> there = stamp_of(step.target);
  const bool is_new = there && *there == step.stamp;
  int error = 0;
  if (step.replaces && (is_new || !there)) {
    if (::rename(step.before.c_str(), step.target.c_str()) != 0) error = errno;
    if (error == ENOENT) error = 0;  // the target was not touched
  } else if (!step.replaces && is_new) {
    if (::unlink(step.target.c_str()) != 0) error = errno;
  }
  // Two names of one file both outlive a rename.
  return error == 0 ? remove_earlier(step) : error;
}

// Does one of these for all steps, from the last one on. Returns 0 or an errno.
int for_all(std::span<const Step> steps, int (*function)(const Step&)) {
  int error = 0;
  for (std::size_t i = steps.size(); i-- > 0;)
    if (const int failed = function(steps[i]); error == 0) error = failed;
  return error;
}

// Keeps the earlier file under its other name, and gives the new one its own. The earlier file is
// moved only where the file system has no hard links. Returns 0 or an errno.
int place(const fs::path& temporary, const Step& step) {
  const char *target = step.target.c_str(), *before = step.before.c_str();
  if (step.replaces && ::link(target, before) != 0 && is_file(step.target) &&
      ::rename(target, before) != 0)
    return errno;
  return ::rename(temporary.c_str(), target) == 0 ? 0 : errno;
}

// Waits until the disk holds a file or a folder's list of files. Returns 0 or an errno.
int flush(const fs::path& path) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) return errno;
  int error = ::fsync(file) == 0 ? 0 : errno;
  if (error == EINVAL) error = 0;  // some file systems cannot flush folders
  ::close(file);
  return error;
}

// The journal of a folder. Its first byte is its state; then, each ended by a 0, follow its format
// and six fields a step. Names are relative to the folder, so that this may be moved.
class Journal {
 public:
  explicit Journal(const fs::path& folder)
      : folder_(folder), path_(folder / fmt::format(".libatlas-commit-{}", ::geteuid())) {}
  ~Journal() {
    if (file_ >= 0) ::close(file_);
  }
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;

  bool is_there() const { return stamp_of(path_).has_value(); }

  // Creates the journal and waits until no other process has it open. Then undoes what the journal
  // of an interrupted process says.
  Status open();
  // Writes what will be done. From then on, the next open() would undo it.
  Status begin(std::span<const Step> steps, bool durable);
  // From then on, the next open() would only remove the earlier files. If it fails, it would still
  // undo what was done.
  Status end(bool durable);
  void remove() { ::unlink(path_.c_str()); }

 private:
  static constexpr char kWriting = 'w', kPending = 'p', kDone = 'd';
  static constexpr std::string_view kFormat = "libatlas commit 1";

  Status lock();
  Status recover();
  Status mark(char state, bool durable);
  Status failed(std::string_view what) const { return failure(path_.string(), what, errno); }
  std::optional<std::vector<Step>> steps_in(std::string_view text) const;

  fs::path folder_, path_;
  int file_ = -1;
};

Status Journal::lock() {
  constexpr int kTries = 1000;
  constexpr std::chrono::milliseconds kPause(10);
  for (int i = 0; ::flock(file_, LOCK_EX | LOCK_NB) != 0; ++i) {
    if (errno != EWOULDBLOCK && errno != EINTR) break;  // a file system without locks
    if (i >= kTries)
      return {ErrorCode::io, fmt::format("{}: another run has been putting files in place for {} s "
                                         "(end it, then run again)",
                                         path_.string(), kTries * kPause.count() / 1000)};
    std::this_thread::sleep_for(kPause);
  }
  return {};
}

Status Journal::open() {
  for (;;) {
    // Nobody else may lead us to another file, or have us put in place what their journal says.
    file_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0600);
    struct stat own {
    }, there{};
    if (file_ < 0 || ::fstat(file_, &own) != 0) return failed("cannot be opened");
    if (own.st_uid != ::geteuid() || !S_ISREG(own.st_mode) || own.st_nlink > 1)
      return {ErrorCode::io,
              fmt::format("{}: is not a journal of this user (remove it)", path_.string())};
    if (Status s = lock(); !s.ok()) return s;
    // Its last owner may have removed it while we waited.
    if (::lstat(path_.c_str(), &there) == 0 && there.st_ino == own.st_ino) return recover();
    ::close(file_);
    file_ = -1;
  }
}

Status Journal::recover() {
  std::string text;
  char part[4096];
  ssize_t got = 0;
  while ((got = ::read(file_, part, sizeof part)) > 0) text.append(part, std::size_t(got));
  if (got < 0) return failed("cannot be read");
  if (text.empty() || text[0] == kWriting) return {};
  const std::optional<std::vector<Step>> steps = steps_in(std::string_view(text).substr(1));
  if (!steps)
    return {ErrorCode::io, fmt::format("{}: is damaged, so it is not known which files an "
                                       "interrupted run has replaced (remove it, and write them "
                                       "anew)",
                                       path_.string())};
  const bool done = text[0] == kDone;
  const int error = for_all(*steps, done ? remove_earlier : undo);
  if (error == 0 || done) return {};
  return failure(path_.string(), "what an interrupted run has replaced cannot be put back", error);
}

std::optional<std::vector<Step>> Journal::steps_in(std::string_view text) const {
  std::vector<std::string_view> fields;
  while (!text.empty()) {
    const std::size_t end = text.find('\0');
    if (end == text.npos) return {};
    fields.push_back(text.substr(0, end));
    text.remove_prefix(end + 1);
  }
  constexpr std::size_t kFields = 6;
  if (fields.empty() || fields[0] != kFormat || fields.size() % kFields != 1) return {};
  std::vector<Step> steps;
  for (std::size_t i = 1; i < fields.size(); i += kFields) {
    Step step{folder_ / fields[i], folder_ / fields[i + 1], fields[i + 2] == "1"};
    std::int64_t* const numbers[] = {&step.stamp.size, &step.stamp.seconds,
                                     &step.stamp.nanoseconds};
    for (std::size_t k = 0; k < 3; ++k) {
      const std::string_view field = fields[i + 3 + k];
      if (std::from_chars(field.data(), field.data() + field.size(), *numbers[k]).ec != std::errc())
        return {};
    }
    steps.push_back(std::move(step));
  }
  return steps;
}

Status Journal::begin(std::span<const Step> steps, bool durable) {
  std::string text(1, kWriting);
  const auto add = [&](const std::string& field) { text.append(field).push_back('\0'); };
  const auto name = [&](const fs::path& file) {
    std::error_code ignored;  // then the name stays as it is, for a process in the same folder
    const bool inside = folder_of(file) == folder_;
    const fs::path whole = inside ? file.filename() : fs::absolute(file, ignored);
    return whole.empty() ? file.string() : whole.string();
  };
  add(std::string(kFormat));
  for (const Step& step : steps) {
    add(name(step.target));
    add(name(step.before));
    add(step.replaces ? "1" : "0");
    for (const std::int64_t number : {step.stamp.size, step.stamp.seconds, step.stamp.nanoseconds})
      add(fmt::format("{}", number));
  }
  if (::ftruncate(file_, 0) != 0) return failed("cannot be written");
  for (std::size_t done = 0; done < text.size();) {
    const ssize_t put = ::pwrite(file_, text.data() + done, text.size() - done, off_t(done));
    if (put < 0 && errno == EINTR) continue;
    if (put < 0) return failed("cannot be written");
    done += std::size_t(put);
  }
  if (Status s = mark(kPending, durable); !s.ok()) return s;
  const int error = durable ? flush(folder_) : 0;
  return error == 0 ? Status() : failure(folder_.string(), "cannot be flushed", error);
}

Status Journal::end(bool durable) {
  Status status = mark(kDone, durable);
  if (!status.ok()) (void)mark(kPending, false);  // it was written, but not flushed
  return status;
}

// The state is a byte in its place, so that it is either the earlier or the new one.
Status Journal::mark(char state, bool durable) {
  if (::pwrite(file_, &state, 1, 0) != 1) return failed("cannot be written");
  if (durable && ::fsync(file_) != 0) return failed("cannot be flushed");
  return {};
}

Status put_in_place(std::span<const Replacement> files, std::span<const Step> steps, bool durable) {
  for (std::size_t i = 0; i < files.size(); ++i)
    if (const int error = place(files[i].temporary, steps[i]); error != 0)
      return failure(files[i].name, "cannot be put in place", error);
  fs::path flushed;
  for (std::size_t i = 0; durable && i < files.size(); ++i) {
    const fs::path folder = folder_of(files[i].target);
    if (folder == flushed) continue;
    if (const int error = flush(folder); error != 0)
      return failure(files[i].name, "its folder cannot be flushed", error);
    flushed = folder;
  }
  return {};
}

// Says what is there before the first rename.
Result<std::vector<Step>> steps_of(std::span<const Replacement> files) {
  std::vector<Step> steps;
  for (const Replacement& file : files) {
    const std::optional<Stamp> stamp = stamp_of(file.temporary);
    if (!stamp) return failure(file.name, "cannot be put in place", errno);
    steps.push_back({file.target, file.before, stamp_of(file.target).has_value(), *stamp});
  }
  return steps;
}

}  // namespace

Status replace_files(std::span<const Replacement> files, bool durable) {
  for (std::size_t i = 0; durable && i < files.size(); ++i)
    if (const int error = flush(files[i].temporary); error != 0)
      return failure(files[i].name, "cannot be flushed", error);
  // One rename is done or not, and needs no journal.
  if (files.size() < 2) {
    const std::vector<Step> steps(files.size(), Step{files.empty() ? "" : files[0].target, {}});
    return put_in_place(files, steps, durable);
  }
  Journal journal(folder_of(files[0].target));
  if (Status s = journal.open(); !s.ok()) return s;
  const Result<std::vector<Step>> steps = steps_of(files);
  Status status = steps.ok() ? journal.begin(*steps, durable) : steps.status();
  const bool begun = status.ok();
  if (begun) status = put_in_place(files, *steps, durable);
  if (status.ok()) status = journal.end(durable);
  // What cannot be done now is left to the next run.
  const int left = begun ? for_all(*steps, status.ok() ? remove_earlier : undo) : 0;
  if (left == 0) journal.remove();
  if (status.ok() || left == 0) return status;
  return {status.code(), status.message() + " (what was replaced comes back with the next run)"};
}

Status undo_interrupted(const fs::path& folder) {
  Journal journal(folder.empty() ? fs::path(".") : folder);
  if (!journal.is_there()) return {};
  Status status = journal.open();
  if (status.ok()) journal.remove();
  return status;
}

}  // namespace atlas
