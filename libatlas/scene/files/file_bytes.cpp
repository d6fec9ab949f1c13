#include "libatlas/scene/files/file_bytes.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>

namespace atlas {
namespace fs = std::filesystem;
namespace {

constexpr std::string_view kMark = "\xef\xbb\xbf";

// Lines end in a lone carriage return in files of old Macs and of programs that keep to their
// convention. Files edited on several systems mix all line ends. A carriage return before a newline
// counts as a blank and stays.
void turn_returns(char* at, char* end) {
  while ((at = static_cast<char*>(std::memchr(at, '\r', std::size_t(end - at))))) {
    char* after = std::find_if(at, end, [](char c) { return c != '\r'; });
    if (after == end || *after != '\n') std::fill(at, after, '\n');
    at = after;
  }
}

}  // namespace

Result<FileBytes> read_file_bytes(const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (status.type() == fs::file_type::not_found) {
    return Status(ErrorCode::not_found,
                  fmt::format("{}: no such file (check the name)", path.string()));
  }
  if (fs::is_directory(status)) {
    return Status(ErrorCode::io,
                  fmt::format("{}: is a directory (name a file inside it)", path.string()));
  }
  if (error) {
    return Status(ErrorCode::io,
                  fmt::format("{}: cannot be read: {}", path.string(), error.message()));
  }
  // A pipe that nobody writes to would never open, so this is asked before the file is opened.
  const bool regular = fs::is_regular_file(status);
  std::FILE* file = regular ? std::fopen(path.c_str(), "rb") : nullptr;
  if (!file) {
    return Status(ErrorCode::io,
                  fmt::format("{}: cannot be read: {}", path.string(),
                              regular ? std::strerror(errno) : "not a regular file"));
  }
  FileBytes bytes;
  bytes.size = fs::file_size(path, error);
  bytes.data = std::make_unique_for_overwrite<char[]>(bytes.size + 1);
  const std::size_t got = std::fread(bytes.data.get(), 1, bytes.size, file);
  std::fclose(file);
  if (error || got != bytes.size) {
    return Status(ErrorCode::io, fmt::format("{}: reading failed after {} of {} bytes",
                                             path.string(), got, bytes.size));
  }
  bytes.data[bytes.size] = '\n';
  return bytes;
}

bool begins_with_mark(const FileBytes& bytes) {
  return bytes.text().starts_with(kMark);
}

Status turn_into_lines(FileBytes& bytes, const fs::path& path) {
  const std::string_view text = bytes.text();
  if (text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff")) {
    return {ErrorCode::unsupported,
            fmt::format("{}: text in UTF-16 (save it as UTF-8)", path.string())};
  }
  if (begins_with_mark(bytes)) std::fill_n(bytes.data.get(), kMark.size(), ' ');
  turn_returns(bytes.data.get(), bytes.data.get() + bytes.size);
  return {};
}

Result<FileBytes> read_text_bytes(const fs::path& path) {
  auto bytes = read_file_bytes(path);
  if (!bytes.ok()) return bytes;
  if (Status s = turn_into_lines(*bytes, path); !s.ok()) return s;
  return bytes;
}

Result<std::string> read_text_or_gzip(const fs::path& path, std::size_t most) {
  auto bytes = read_file_bytes(path);
  if (!bytes.ok()) return bytes.status();
  std::string text;
  if (!bytes->text().starts_with("\x1f\x8b")) {
    turn_returns(bytes->data.get(), bytes->data.get() + bytes->size);
    const std::size_t mark = begins_with_mark(*bytes) ? kMark.size() : 0;
    text.assign(bytes->begin() + mark, bytes->size + 1 - mark);  // with its newline
    return text;
  }
  gzFile file = gzopen(path.c_str(), "rb");
  if (!file) return Status(ErrorCode::io, path.string() + ": cannot be read");
  gzbuffer(file, 1 << 18);
  std::string piece(std::size_t{1} << 20, '\0');
  int got = 0, error = Z_OK;
  do {
    got = gzread(file, piece.data(), static_cast<unsigned>(piece.size()));
    if (got > 0) text.append(piece.data(), static_cast<std::size_t>(got));
    // Asked after every read: from zlib 1.3.2 on, the next read forgets that the file ended within
    // a stream.
    gzerror(file, &error);
  } while (got > 0 && error == Z_OK && text.size() < most);
  gzclose(file);
  if (text.size() >= most) {
    return Status(ErrorCode::unsupported,
                  fmt::format("{}: holds {} MiB of text or more, unpacked (split the scene; "
                              "ReadOptions::limits lifts the limit)",
                              path.string(), most >> 20));
  }
  if (error != Z_OK) {
    return Status(
        ErrorCode::bad_input,
        fmt::format("{}: damaged or cut short gzip data (copy the file again)", path.string()));
  }
  if (text.starts_with(kMark)) text.erase(0, kMark.size());
  turn_returns(text.data(), text.data() + text.size());
  text += '\n';
  return text;
}

}  // namespace atlas
