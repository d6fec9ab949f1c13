// Internal: which files the names in OBJ and MTL files mean.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace atlas {

// What the quotes at the beginning of `text` enclose, which some programs write around names with
// blanks; empty where there are none.
std::string_view quoted_name(std::string_view text);

struct LibraryFile {
  std::filesystem::path path;
  bool exists;
};

// Finds files by their names. It lists each folder once only, since thousands of names may be
// missing in a folder of thousands of files.
class NamedFiles {
 public:
  // The file that `name` means in a file of `folder`: backslashes part folders as slashes do, and a
  // file that is not where the name says, as those of another machine, is looked for in `folder`,
  // and both once more in any mix of capitals and small letters. Where there is none it is the
  // first.
  std::filesystem::path file(const std::filesystem::path& folder, std::string_view name);

  // The files of an `mtllib` line, whose names are apart by blanks, and may hold blanks. The
  // longest run of words that is a file wins; what is none goes as far as ".mtl". What begins with
  // '#' where a name could is a comment.
  std::vector<LibraryFile> library_files(const std::filesystem::path& folder,
                                         std::string_view names);

 private:
  // The entries of a folder by their names in small letters. Of entries whose names differ only in
  // case it has the first in the order of their bytes.
  using Listing = std::unordered_map<std::string, std::filesystem::path>;

  const Listing& listing(const std::filesystem::path& folder);
  std::filesystem::path in_any_case(const std::filesystem::path& folder,
                                    const std::filesystem::path& name);
  std::filesystem::path file_in_any_case(const std::filesystem::path& folder,
                                         const std::filesystem::path& path);

  std::map<std::filesystem::path, Listing> listings_;
};

}  // namespace atlas
