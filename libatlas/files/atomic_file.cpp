#include "libatlas/files/atomic_file.h"

#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstring>

#include "libatlas/files/leftovers.h"
#include "libatlas/files/links.h"
#include "libatlas/files/replace_files.h"
#include "libatlas/files/write_error.h"

namespace atlas {
namespace fs = std::filesystem;
namespace {

// Returns a hidden name in the same folder. Long names are shortened so that file systems accept
// the result. The number distinguishes all files of this process, whose threads may write to the
// same target.
fs::path name_beside(const fs::path& target, std::string_view kind) {
  static std::atomic<std::uint64_t> number = 0;
  constexpr std::size_t kLongestStem = 120, kLongestExtension = 60;  // bytes
  std::string stem = target.stem().string(), extension = target.extension().string();
  if (stem.size() > kLongestStem) {
    std::size_t end = kLongestStem;
    // Does not cut a UTF-8 character.
    while (end > 0 && (static_cast<unsigned char>(stem[end]) & 0xc0) == 0x80) --end;
    stem.resize(end);
  }
  if (extension.size() > kLongestExtension) extension.clear();
  fs::path beside = target;
  beside.replace_filename(
      fmt::format(".{}.{}.{}.{}{}", stem, process_mark(), kind, ++number, extension));
  return beside;
}

// Returns whether this is something that a file cannot replace: a device, a pipe, a socket.
bool is_special(const fs::path& path) {
  std::error_code error;
  return fs::is_other(path, error);
}

}  // namespace

AtomicFiles::~AtomicFiles() {
  std::error_code ignored;  // a file that was never created is not there to remove
  for (const Entry& entry : entries_)
    if (entry.temporary != entry.target) fs::remove(entry.temporary, ignored);
}

fs::path AtomicFiles::path_for(const fs::path& name) {
  const fs::path target = end_of_links(name), folder = target.parent_path();
  // Links without an end stay as they are, since opening them fails.
  const bool in_place = is_special(target) || links_have_no_end(target);
  if (entries_.empty() || entries_.back().target.parent_path() != folder) {
    if (Status s = undo_interrupted(folder); !s.ok()) interrupted_ = s;
    remove_leftovers(folder);
  }
  const fs::path temporary = in_place ? target : name_beside(target, "part");
  entries_.push_back({temporary, target, name});
  return temporary;
}

Status AtomicFiles::told_by_target(const Status& status) const {
  std::string message = status.message();
  for (const Entry& entry : entries_) {
    const std::string temporary = entry.temporary.string(), name = entry.name.string();
    for (auto at = message.find(temporary); at != std::string::npos;
         at = message.find(temporary, at + name.size()))
      message.replace(at, temporary.size(), name);
  }
  return {status.code(), message};
}

void AtomicFiles::discard(const fs::path& temporary) {
  std::error_code ignored;  // one that was never created is not there to remove
  std::erase_if(entries_, [&](const Entry& entry) {
    if (entry.temporary != temporary) return false;
    if (temporary != entry.target) fs::remove(temporary, ignored);
    return true;
  });
}

std::vector<fs::path> AtomicFiles::targets() const {
  std::vector<fs::path> paths;
  for (const Entry& entry : entries_) paths.push_back(entry.name);
  return paths;
}

Status AtomicFiles::commit(bool durable) {
  if (!interrupted_.ok()) return interrupted_;
  std::vector<Replacement> files;
  for (const Entry& entry : entries_) {
    if (entry.temporary == entry.target) continue;
    files.push_back(
        {entry.temporary, entry.target, name_beside(entry.target, "before"), entry.name.string()});
  }
  if (Status s = replace_files(files, durable); !s.ok()) return s;
  entries_.clear();
  return {};
}

Status check_writable(const fs::path& name) {
  if (links_have_no_end(name)) {
    return {ErrorCode::io,
            fmt::format("{}: cannot be written: its symbolic links lead to no file but back to "
                        "themselves (remove them, or give another name)",
                        name.string())};
  }
  const fs::path target = end_of_links(name);
  const fs::path directory = target.has_parent_path() ? target.parent_path() : fs::path(".");
  const auto refuse = [&](const std::string& why) {
    return Status(ErrorCode::io, fmt::format("{}: cannot be written: {} {}", name.string(),
                                             directory.string(), why));
  };
  std::error_code error;
  const fs::file_status folder = fs::status(directory, error);
  if (error && folder.type() != fs::file_type::not_found)
    return refuse(fmt::format("cannot be looked at: {}", error.message()));
  if (!fs::exists(folder)) return refuse("does not exist (create it first)");
  if (!fs::is_directory(folder)) return refuse("is not a directory (name a folder)");
  const fs::file_status there = fs::status(target, error);
  const long longest = ::pathconf(directory.c_str(), _PC_NAME_MAX);
  if (longest > 0 && target.filename().string().size() > std::size_t(longest))
    return refuse(fmt::format("takes names of up to {} bytes (give a shorter one)", longest));
  if (fs::is_other(there)) return {};
  if (::access(directory.c_str(), W_OK | X_OK) != 0)
    return refuse(
        fmt::format("does not take files: {} (name another folder)", std::strerror(errno)));
  if (fs::is_directory(there)) return refuse("has a directory of that name");
  return {};
}

Status AtomicFiles::write(const fs::path& target, std::string_view bytes) {
  std::FILE* file = std::fopen(path_for(target).c_str(), "wb");
  if (!file) {
    return {ErrorCode::io,
            fmt::format("{}: cannot be written: {}", target.string(), std::strerror(errno))};
  }
  const bool written = std::fwrite(bytes.data(), 1, bytes.size(), file) == bytes.size();
  const int error = errno;
  if (std::fclose(file) != 0 || !written) {
    return {ErrorCode::io, fmt::format("{}: writing failed: {}", target.string(),
                                       write_error(written ? errno : error))};
  }
  return {};
}

Status write_file(const fs::path& target, std::string_view bytes) {
  AtomicFiles files;
  if (Status s = files.write(target, bytes); !s.ok()) return s;
  return files.commit();
}

}  // namespace atlas
