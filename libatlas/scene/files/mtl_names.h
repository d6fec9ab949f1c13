// Internal: finds the files that names in OBJ and MTL files mean.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace atlas {

// Returns what the quotes at the beginning of `text` enclose, or an empty string if there are none.
// Some programs write quotes around names that contain blanks.
std::string_view quoted_name(std::string_view text);

struct LibraryFile {
  std::filesystem::path path;
  bool exists;
};

// Finds files by their names. Lists each folder only once, since thousands of names may be missing
// in a folder of thousands of files.
class NamedFiles {
 public:
  // From now on, what lies outside of `folder` counts as missing (ReadOptions::confine).
  void confine_to(const std::filesystem::path& folder);

  // Returns whether the path, after links are followed, lies in the folder that it must lie in, or
  // below it. It need not exist.
  bool allows(const std::filesystem::path& path) const;
  // Returns whether there is such a file, or anything of this name, that is allowed.
  bool is_file(const std::filesystem::path& path) const;
  bool exists(const std::filesystem::path& path) const;

  // Returns the file that `name` means in a file of `folder`. Backslashes separate folders as
  // slashes do. A file that is not where the name says, as with paths of another machine, is looked
  // for in `folder` itself; then both places are searched again without regard to case. If no file
  // is found, returns the first path.
  std::filesystem::path file(const std::filesystem::path& folder, std::string_view name);

  // Returns the files of an `mtllib` line, whose names are separated by blanks and may contain
  // blanks. The longest run of words that is a file is taken as a name. A name that is no file
  // extends to ".mtl". A '#' where a name could begin starts a comment.
  std::vector<LibraryFile> library_files(const std::filesystem::path& folder,
                                         std::string_view names);

 private:
  // The entries of a folder, by their names in small letters. Of entries whose names differ only in
  // case, it holds the first in byte order.
  using Listing = std::unordered_map<std::string, std::filesystem::path>;

  const Listing& listing(const std::filesystem::path& folder);
  std::size_t longest_file(const std::filesystem::path& folder, std::string_view names) const;
  std::size_t unknown_name(const std::filesystem::path& folder, std::string_view names) const;
  std::filesystem::path in_any_case(const std::filesystem::path& folder,
                                    const std::filesystem::path& name);
  std::filesystem::path file_in_any_case(const std::filesystem::path& folder,
                                         const std::filesystem::path& path);

  std::map<std::filesystem::path, Listing> listings_;
  std::optional<std::filesystem::path> inside_;  // without links
};

}  // namespace atlas
