#include "libatlas/files/links.h"

#include <system_error>

namespace atlas {
namespace fs = std::filesystem;

bool links_have_no_end(const fs::path& path) {
  std::error_code error;
  (void)fs::exists(path, error);
  return error == std::errc::too_many_symbolic_link_levels;
}

fs::path end_of_links(const fs::path& path) {
  std::error_code error;
  if (!fs::is_symlink(path, error) || links_have_no_end(path)) return path;
  if (fs::exists(path, error)) {
    // A descriptor of /proc is a link whose text is no path if it leads to a pipe.
    const fs::path end = fs::canonical(path, error);
    return error ? path : end;
  }
  fs::path end = path;
  while (fs::is_symlink(end, error)) {
    const fs::path next = fs::read_symlink(end, error);
    if (error) return path;
    end = end.parent_path() / next;  // which is `next` if that is absolute
  }
  return end;
}

}  // namespace atlas
