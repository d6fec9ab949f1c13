#include "libatlas/scene/file_bytes.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

namespace atlas {
namespace fs = std::filesystem;

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
  std::FILE* file = std::fopen(path.c_str(), "rb");
  if (!file || !fs::is_regular_file(status)) {
    const int open_error = errno;
    if (file) std::fclose(file);
    return Status(ErrorCode::io,
                  fmt::format("{}: cannot be read: {}", path.string(),
                              file ? "not a regular file" : std::strerror(open_error)));
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

}  // namespace atlas
