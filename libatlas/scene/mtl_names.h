// Internal: which files the names in OBJ and MTL files mean.
#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

namespace atlas {

// The file that `name` means in a file of `folder`: backslashes part folders as slashes do, and a
// file that is not where the name says, as those of another machine, is looked for in `folder`,
// and both once more in any mix of capitals and small letters. Where there is none it is the first.
std::filesystem::path named_file(const std::filesystem::path& folder, std::string_view name);

// What the quotes at the beginning of `text` enclose, which some programs write around names with
// blanks; empty where there are none.
std::string_view quoted_name(std::string_view text);

struct LibraryFile {
  std::filesystem::path path;
  bool exists;
};

// The files of an `mtllib` line, whose names are apart by blanks, and may hold blanks. The longest
// run of words that is a file wins; what is none goes as far as ".mtl". What begins with '#' where
// a name could is a comment.
std::vector<LibraryFile> library_files(const std::filesystem::path& folder, std::string_view names);

}  // namespace atlas
