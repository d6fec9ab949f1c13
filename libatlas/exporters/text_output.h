// Internal: large text files from pieces that are formatted in parallel.
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

// A relative reference in plain ASCII without blanks: some readers split lists there, some choke on
// UTF-8. Names from safe_file_name() stay as they are.
std::string encode_uri(const std::string& name);

// A file, plain or gzipped, that remembers its first error.
class TextFile {
 public:
  TextFile(const std::filesystem::path& temporary, const std::filesystem::path& target, bool gzip);
  ~TextFile();
  TextFile(const TextFile&) = delete;
  TextFile& operator=(const TextFile&) = delete;

  void write(std::string_view bytes);
  // Formats items [0, n) in pieces, in parallel, and writes the pieces in order.
  void write_items(std::size_t n, const Context& context,
                   const std::function<void(TextBuffer& out, std::size_t item)>& format);
  // Closes; io with the system's reason if anything failed, cancelled if writing was cut short.
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
