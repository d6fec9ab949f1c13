// Internal: TextFile, which writes large text files in pieces that are formatted in parallel.
#pragma once

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

#include "libatlas/core/context.h"
#include "libatlas/core/status.h"
#include "libatlas/core/text_buffer.h"

namespace atlas {

// Returns a relative reference in plain ASCII without blanks, because some readers split lists at
// blanks and some fail on UTF-8, and without a colon, before which they see a scheme. Names from
// safe_file_name() stay unchanged.
std::string encode_uri(const std::string& name);

// A file, plain or gzipped, that remembers its first error.
class TextFile {
 public:
  TextFile(const std::filesystem::path& temporary, const std::filesystem::path& target, bool gzip);
  ~TextFile();
  TextFile(const TextFile&) = delete;
  TextFile& operator=(const TextFile&) = delete;

  void write(std::string_view bytes);
  // Formats the items [0, n) in pieces, in parallel, and writes the pieces in order.
  void write_items(std::size_t n, const Context& context,
                   const std::function<void(TextBuffer& out, std::size_t item)>& format);
  // Closes the file. Errors: io with the system's reason if anything failed; cancelled if writing
  // was cut short.
  Status finish();
  std::int64_t bytes() const { return bytes_; }

 private:
  void fail();

  std::filesystem::path target_;
  std::FILE* plain_ = nullptr;
  void* zipped_ = nullptr;  // gzFile
  std::int64_t bytes_ = 0;  // of text, before compression
  Status status_;
};

}  // namespace atlas
