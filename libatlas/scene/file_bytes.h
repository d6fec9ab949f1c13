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

// The same for text: a byte order mark becomes blanks, and where lines end by a carriage return
// alone, by a newline. Errors: the same, and unsupported for UTF-16.
Result<FileBytes> read_text_bytes(const std::filesystem::path& path);

// The text of a plain or gzipped file, followed by a newline. Errors: the same, and bad_input for
// damaged gzip data or more than 8 GiB of text.
Result<std::string> read_text_or_gzip(const std::filesystem::path& path);

}  // namespace atlas
