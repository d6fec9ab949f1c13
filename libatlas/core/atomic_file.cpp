#include "libatlas/core/atomic_file.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

namespace atlas {
namespace fs = std::filesystem;
namespace {

std::string name_beside(const fs::path& target, std::string_view kind) {
  return fmt::format(".{}.{}.{}{}", target.stem().string(), ::getpid(), kind,
                     target.extension().string());
}

}  // namespace

AtomicFiles::~AtomicFiles() {
  std::error_code ignored;  // a file that was never created is not there to remove
  for (const Entry& entry : entries_) fs::remove(entry.temporary, ignored);
}

fs::path AtomicFiles::path_for(const fs::path& target) {
  fs::path temporary = target;
  temporary.replace_filename(name_beside(target, "part"));
  entries_.push_back({temporary, target});
  return temporary;
}

void AtomicFiles::discard(const fs::path& temporary) {
  std::error_code ignored;  // one that was never created is not there to remove
  fs::remove(temporary, ignored);
  std::erase_if(entries_, [&](const Entry& entry) { return entry.temporary == temporary; });
}

std::vector<fs::path> AtomicFiles::targets() const {
  std::vector<fs::path> paths;
  for (const Entry& entry : entries_) paths.push_back(entry.target);
  return paths;
}

Status AtomicFiles::put_in_place(Entry& entry) {
  std::error_code error;
  fs::path before = entry.target;
  before.replace_filename(name_beside(entry.target, "before"));
  fs::create_hard_link(entry.target, before, error);
  if (!error) entry.before = before;
  fs::rename(entry.temporary, entry.target, error);
  if (!error) return {};
  return {ErrorCode::io,
          fmt::format("{}: cannot be put in place: {}", entry.target.string(), error.message())};
}

void AtomicFiles::take_back(Entry& entry) {
  std::error_code ignored;  // there is nothing more to be done
  if (entry.before.empty()) {
    fs::remove(entry.target, ignored);
  } else {
    fs::rename(entry.before, entry.target, ignored);
  }
  entry.before.clear();
}

Status AtomicFiles::commit() {
  std::error_code ignored;
  Status status;
  std::size_t placed = 0;
  while (placed < entries_.size() && (status = put_in_place(entries_[placed])).ok()) ++placed;
  if (!status.ok()) {
    fs::remove(entries_[placed].before, ignored);
    while (placed > 0) take_back(entries_[--placed]);
    return status;
  }
  for (const Entry& entry : entries_) fs::remove(entry.before, ignored);
  entries_.clear();
  return {};
}

Status check_writable(const fs::path& target) {
  const fs::path directory = target.has_parent_path() ? target.parent_path() : fs::path(".");
  const auto refuse = [&](const char* why) {
    return Status(ErrorCode::io, fmt::format("{}: cannot be written: {} {}", target.string(),
                                             directory.string(), why));
  };
  if (!fs::is_directory(directory)) return refuse("is not a directory (create it first)");
  if (::access(directory.c_str(), W_OK) != 0) return refuse("does not take files");
  if (fs::is_directory(target)) return refuse("has a directory of that name");
  return {};
}

Status write_file(const fs::path& target, std::string_view bytes) {
  AtomicFiles files;
  const fs::path path = files.path_for(target);
  std::FILE* file = std::fopen(path.c_str(), "wb");
  if (!file) {
    return {ErrorCode::io,
            fmt::format("{}: cannot be written: {}", target.string(), std::strerror(errno))};
  }
  const bool written = std::fwrite(bytes.data(), 1, bytes.size(), file) == bytes.size();
  const int write_error = errno;
  if (std::fclose(file) != 0 || !written) {
    return {ErrorCode::io, fmt::format("{}: writing failed: {}", target.string(),
                                       std::strerror(written ? errno : write_error))};
  }
  return files.commit();
}

}  // namespace atlas
