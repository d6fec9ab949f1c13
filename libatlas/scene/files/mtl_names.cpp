#include "libatlas/scene/files/mtl_names.h"

#include <algorithm>
#include <string>

#include "libatlas/core/small_letters.h"
#include "libatlas/files/file_extension.h"

namespace atlas {
namespace fs = std::filesystem;
namespace {

constexpr std::string_view kBlanks = " \t";
// Limit on the words of one name, since lines may be long and each run of words is looked up.
constexpr int kMostWords = 32;

fs::path path_in(const fs::path& folder, std::string_view name) {
  std::string path(name);
  std::replace(path.begin(), path.end(), '\\', '/');
  return folder / path;
}

// Returns where the word that begins at `begin` ends.
std::size_t word_end(std::string_view text, std::size_t begin) {
  return std::min(text.find_first_of(kBlanks, begin), text.size());
}

std::size_t next_word(std::string_view text, std::size_t end) {
  return std::min(text.find_first_not_of(kBlanks, end), text.size());
}

}  // namespace

void NamedFiles::confine_to(const fs::path& folder) {
  std::error_code error;  // nothing lies in a folder that cannot be examined
  inside_ = fs::weakly_canonical(folder.empty() ? "." : folder, error);
}

bool NamedFiles::allows(const fs::path& path) const {
  if (!inside_) return true;
  std::error_code error;
  const fs::path file = fs::weakly_canonical(fs::absolute(path, error), error);
  if (error || inside_->empty()) return false;
  return std::mismatch(inside_->begin(), inside_->end(), file.begin(), file.end()).first ==
         inside_->end();
}

bool NamedFiles::is_file(const fs::path& path) const {
  std::error_code ignored;  // a path that cannot be examined is not a file
  return allows(path) && fs::is_regular_file(path, ignored);
}

bool NamedFiles::exists(const fs::path& path) const {
  std::error_code ignored;  // a path that cannot be examined does not exist
  return allows(path) && fs::exists(path, ignored);
}

// Returns the length of the longest run of words at the beginning that is a file, or 0.
std::size_t NamedFiles::longest_file(const fs::path& folder, std::string_view names) const {
  std::size_t longest = 0, end = word_end(names, 0);
  for (int words = 1; words <= kMostWords; ++words) {
    if (is_file(path_in(folder, names.substr(0, end)))) longest = end;
    if (end == names.size()) break;
    end = word_end(names, next_word(names, end));
  }
  return longest;
}

// Returns the length of a name at the beginning that is no file.
std::size_t NamedFiles::unknown_name(const fs::path& folder, std::string_view names) const {
  std::size_t end = word_end(names, 0);
  for (int words = 1; words < kMostWords; ++words) {
    if (lower_extension(fs::path(names.substr(0, end))) == ".mtl") break;
    const std::size_t next = next_word(names, end);
    if (next == names.size() || names[next] == '#' || names[next] == '"' ||
        longest_file(folder, names.substr(next)) > 0)
      break;
    end = word_end(names, next);
  }
  return end;
}

const NamedFiles::Listing& NamedFiles::listing(const fs::path& folder) {
  const auto [at, is_new] = listings_.try_emplace(folder);
  if (!is_new) return at->second;
  std::error_code ignored;  // a folder that cannot be listed holds nothing
  for (fs::directory_iterator entry(folder.empty() ? "." : folder, ignored), end; entry != end;
       entry.increment(ignored)) {
    const fs::path name = entry->path().filename();
    fs::path& first = at->second[small_letters(name.string())];
    if (first.empty() || name < first) first = name;
  }
  return at->second;
}

// Returns the file or folder of this name in `folder` without regard to case, or an empty path.
fs::path NamedFiles::in_any_case(const fs::path& folder, const fs::path& name) {
  const Listing& names = listing(folder);
  const auto found = names.find(small_letters(name.string()));
  return found == names.end() ? fs::path() : folder / found->second;
}

// Returns the file of this path below `folder`, each part without regard to case, or an empty path.
fs::path NamedFiles::file_in_any_case(const fs::path& folder, const fs::path& path) {
  if (path.is_absolute()) return {};
  fs::path at = folder;
  for (const fs::path& part : path) {
    at = exists(at / part) ? at / part : in_any_case(at, part);
    if (at.empty()) return {};
  }
  return is_file(at) ? at : fs::path();
}

fs::path NamedFiles::file(const fs::path& folder, std::string_view name) {
  const fs::path exact = path_in(folder, name), beside = folder / exact.filename();
  if (exists(exact)) return exact;
  if (is_file(beside)) return beside;
  // The file may come from a system that ignores case.
  for (const fs::path& path : {exact.lexically_relative(folder), exact.filename()}) {
    if (fs::path found = file_in_any_case(folder, path); !found.empty()) return found;
  }
  return exact;
}

std::string_view quoted_name(std::string_view text) {
  if (text.empty() || text[0] != '"') return {};
  const std::size_t end = text.find('"', 1);
  return end == text.npos ? std::string_view() : text.substr(1, end - 1);
}

std::vector<LibraryFile> NamedFiles::library_files(const fs::path& folder, std::string_view names) {
  std::vector<LibraryFile> files;
  while (!names.empty()) {
    std::size_t length = longest_file(folder, names);
    if (length == 0 && names[0] == '#') break;
    std::string_view name = names.substr(0, length);
    if (length == 0) {
      name = quoted_name(names);
      length = name.empty() ? unknown_name(folder, names) : name.size() + 2;
      if (name.empty()) name = names.substr(0, length);
    }
    const fs::path path = file(folder, name);
    files.push_back({path, is_file(path)});
    names.remove_prefix(next_word(names, length));
  }
  return files;
}

}  // namespace atlas
