// Internal: a whole file in memory.
#pragma once

#include <cstddef>
#include <filesystem>
#include <limits>
#include <memory>
#include <string>
#include <string_view>

#include "libatlas/core/status.h"

namespace atlas {

// The bytes of a file, followed by one newline that `size` does not count, so that scanners of
// lines need no end test for each character.
struct FileBytes {
  std::unique_ptr<char[]> data;
  std::size_t size = 0;

  const char* begin() const { return data.get(); }
  const char* end() const { return data.get() + size; }
  std::string_view text() const { return {data.get(), size}; }
};

// Reads a whole file. Errors: not_found; io (not a regular file, or unreadable).
Result<FileBytes> read_file_bytes(const std::filesystem::path& path);

// Returns whether the bytes begin with the byte order mark of UTF-8, which some editors write.
bool begins_with_mark(const FileBytes& bytes);

// Prepares text for scanners of lines: replaces a byte order mark with blanks, and carriage returns
// that end a line without a newline with newlines. Error: unsupported for UTF-16.
Status turn_into_lines(FileBytes& bytes, const std::filesystem::path& path);

// Calls read_file_bytes(), then turn_into_lines().
Result<FileBytes> read_text_bytes(const std::filesystem::path& path);

// Reads a plain or gzipped text file. Returns its text without a byte order mark, with line ends as
// above, followed by one newline. Errors: those of read_file_bytes(); bad_input for damaged gzip
// data; unsupported if gzip data unpack to `most` bytes or more, since a small gzip file can hold
// terabytes.
Result<std::string> read_text_or_gzip(const std::filesystem::path& path,
                                      std::size_t most = std::numeric_limits<std::size_t>::max());

}  // namespace atlas
