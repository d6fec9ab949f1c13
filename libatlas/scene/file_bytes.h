// Internal: a whole file in memory.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "libatlas/core/status.h"

namespace atlas {

// The bytes of a file, followed by one newline that is not part of them, so that scanners of
// lines need no end test for each character.
struct FileBytes {
  std::unique_ptr<char[]> data;
  std::size_t size = 0;

  const char* begin() const { return data.get(); }
  const char* end() const { return data.get() + size; }
  std::string_view text() const { return {data.get(), size}; }
};

// Errors: not_found; io (a directory, unreadable).
Result<FileBytes> read_file_bytes(const std::filesystem::path& path);

// Whether the bytes begin with the byte order mark of UTF-8, which some editors write.
bool begins_with_mark(const FileBytes& bytes);

// Prepares text for scanners of lines: a byte order mark becomes blanks, a carriage return that
// ends a line alone a newline. Errors: unsupported for UTF-16.
Status turn_into_lines(FileBytes& bytes, const std::filesystem::path& path);

// Both at once.
Result<FileBytes> read_text_bytes(const std::filesystem::path& path);

inline constexpr std::size_t kMostText = std::size_t{1} << 33;

// The text of a plain or gzipped file, in lines as above, followed by a newline. Errors: the same;
// bad_input for damaged gzip data; unsupported for `most` bytes or more when unpacked, since a
// small gzip file can hold terabytes.
Result<std::string> read_text_or_gzip(const std::filesystem::path& path,
                                      std::size_t most = kMostText);

}  // namespace atlas
