// Internal: writes pictures so that files are either whole or absent.
#pragma once

#include <filesystem>

#include "libatlas/files/atomic_file.h"
#include "libatlas/image/image_io.h"

namespace atlas {

// Writes a PNG file. Errors: io, naming the file.
inline Status write_picture(const std::filesystem::path& path, const Image8& image) {
  AtomicFiles files;
  if (Status s = write_png(files.path_for(path), image, {}); !s.ok())
    return files.told_by_target(s);
  return files.commit();
}

}  // namespace atlas
