#include "apps/common/files.h"

#include <fmt/format.h>

#include <cctype>

#include "libatlas/core/atomic_file.h"

namespace atlas::app {
namespace {

namespace fs = std::filesystem;

bool same_file(const fs::path& a, const fs::path& b) {
  std::error_code error;
  if (fs::equivalent(a, b, error)) return true;
  // Not there yet: the same name in the same folder.
  const auto folder = [](const fs::path& p) {
    return p.has_parent_path() ? p.parent_path() : fs::path(".");
  };
  return a.filename() == b.filename() && fs::equivalent(folder(a), folder(b), error);
}

}  // namespace

Status check_output(const fs::path& output, std::initializer_list<fs::path> others) {
  if (output.empty()) return {};
  for (const fs::path& other : others)
    if (!other.empty() && same_file(output, other))
      return {
          ErrorCode::bad_option,
          fmt::format("{}: would overwrite {} (give the output another name)", output.string(),
                      output == other ? "a file that is read or written as well" : other.string())};
  return check_writable(output);
}

std::string lower_extension(const fs::path& path) {
  std::string extension = path.extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return extension;
}

}  // namespace atlas::app
