#include "apps/common/files.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "libatlas/files/atomic_file.h"
#include "libatlas/files/links.h"

namespace atlas::app {
namespace {

namespace fs = std::filesystem;

bool same_file(const fs::path& a, const fs::path& b) {
  std::error_code error;
  if (fs::equivalent(a, b, error)) return true;
  // Files that do not exist yet are the same if they have the same name in the same folder, or if
  // links lead there.
  const auto folder = [](const fs::path& p) {
    return p.has_parent_path() ? p.parent_path() : fs::path(".");
  };
  const fs::path x = end_of_links(a), y = end_of_links(b);
  return x.filename() == y.filename() && fs::equivalent(folder(x), folder(y), error);
}

}  // namespace

Status check_output(const fs::path& output, const std::vector<fs::path>& others) {
  if (output.empty()) return {};
  // Other programs take it for standard output, so a file of that name would help nobody.
  if (output == "-")
    return {ErrorCode::bad_option,
            "-: is no name of an output (/dev/stdout is standard output, ./- a file of that name)"};
  for (const fs::path& other : others)
    if (!other.empty() && same_file(output, other))
      return {
          ErrorCode::bad_option,
          fmt::format("{}: would overwrite {} (give the output another name)", output.string(),
                      output == other ? "a file that is read or written as well" : other.string())};
  return check_writable(output);
}

Result<std::string> read_text(const fs::path& path, const Context& context) {
  constexpr std::size_t kMost = std::size_t{1} << 30, kPart = 1 << 16;
  constexpr int kWait = 100;  // ms between two checks of the context
  const auto failed = [&](ErrorCode code, const std::string& why) {
    return Status(code, fmt::format("{}: {}", path.string(), why));
  };
  std::error_code ignored;  // what cannot be looked at cannot be opened either
  if (fs::is_directory(path, ignored))
    return failed(ErrorCode::bad_input, "is a directory (name a file inside it)");
  // Without O_NONBLOCK, open() would wait for the writer of a pipe, and no signal would end that.
  const int file = ::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  if (file < 0 && errno == ENOENT)
    return failed(ErrorCode::not_found, "no such file (check the name)");
  if (file < 0)
    return failed(ErrorCode::io, fmt::format("cannot be read: {}", std::strerror(errno)));
  std::string text;
  ssize_t got = 1;
  while (got != 0 && text.size() <= kMost && !context.cancelled()) {
    pollfd ready{file, POLLIN, 0};
    if (::poll(&ready, 1, kWait) == 0) continue;
    const std::size_t before = text.size();
    text.resize(before + kPart);
    got = ::read(file, text.data() + before, kPart);
    const int reason = errno;
    text.resize(before + std::size_t(std::max<ssize_t>(got, 0)));
    if (got >= 0 || reason == EAGAIN || reason == EINTR) continue;
    ::close(file);
    return failed(ErrorCode::io, fmt::format("cannot be read: {}", std::strerror(reason)));
  }
  ::close(file);
  if (context.cancelled()) return Status::cancelled();
  if (text.size() > kMost)
    return failed(ErrorCode::bad_input, "holds more than 1 GiB (no list is so long)");
  return text;
}

std::vector<fs::path> files_there(std::size_t first,
                                  const std::function<fs::path(std::size_t)>& name) {
  std::vector<fs::path> there;
  std::error_code error;
  for (std::size_t k = first; fs::exists(name(k), error); ++k) there.push_back(name(k));
  return there;
}

std::string old_pages_text(std::span<const fs::path> pages, std::string_view run,
                           std::string_view whole) {
  const std::string last = pages.size() == 1 ? "" : " to " + pages.back().filename().string();
  return fmt::format("{}{}: of an earlier {}, no part of {} (may be removed)",
                     pages.front().string(), last, run, whole);
}

}  // namespace atlas::app
