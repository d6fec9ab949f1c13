#include "libatlas/files/leftovers.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstdint>
#include <fstream>
#include <string_view>

#include "libatlas/core/text_hash.h"

namespace atlas {
namespace fs = std::filesystem;
namespace {

// Returns a hash of the machine's boot and the process namespace, or nothing if the system does not
// tell them. A process number identifies a process only within both, while several machines or
// containers may share a folder.
std::string world_of_processes() {
  std::ifstream start("/proc/sys/kernel/random/boot_id");
  std::string text;
  std::error_code error;
  const fs::path space = fs::read_symlink("/proc/self/ns/pid", error);
  if (!std::getline(start, text) || text.empty() || error) return {};
  return fmt::format("{:08x}", text_hash(text + space.string()));
}

const std::string& world() {
  static const std::string known = world_of_processes();
  return known;
}

bool has_ended(pid_t process) {
  return ::kill(process, 0) != 0 && errno == ESRCH;
}

// Returns whether a file of this name is a temporary file of a process that has ended.
bool is_leftover(std::string_view name) {
  const std::string before_number = fmt::format(".{}-", world());
  const std::size_t at = name.rfind(before_number);
  if (!name.starts_with('.') || at == std::string_view::npos) return false;
  const char* end = name.data() + name.size();
  pid_t process = 0;
  const auto [after, error] =
      std::from_chars(name.data() + at + before_number.size(), end, process);
  if (error != std::errc() || process <= 0) return false;
  const std::string_view rest(after, static_cast<std::size_t>(end - after));
  constexpr std::string_view kKind = ".part";
  if (rest != kKind && (!rest.starts_with(kKind) || rest[kKind.size()] != '.')) return false;
  return has_ended(process);
}

}  // namespace

std::string process_mark() {
  return fmt::format("{}-{}", world(), ::getpid());
}

void remove_leftovers(const fs::path& folder) {
  if (world().empty()) return;
  std::error_code error;
  fs::directory_iterator entry(folder.empty() ? fs::path(".") : folder, error);
  for (; !error && entry != fs::directory_iterator(); entry.increment(error)) {
    std::error_code ignored;  // another process may have removed it meanwhile
    if (is_leftover(entry->path().filename().string())) fs::remove(entry->path(), ignored);
  }
}

}  // namespace atlas
