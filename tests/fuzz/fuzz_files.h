// The files of the fuzz targets, in a folder of their own among the temporary files.
#pragma once

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <numeric>
#include <string>
#include <string_view>

#include "tests/fuzz/targets.h"

namespace atlas::test {

class FuzzFolder {
 public:
  FuzzFolder() {
    path_ = std::filesystem::temp_directory_path() / ("fuzz." + std::to_string(::getpid()));
    std::filesystem::create_directories(path_);
  }
  ~FuzzFolder() { std::filesystem::remove_all(path_); }
  FuzzFolder(const FuzzFolder&) = delete;
  FuzzFolder& operator=(const FuzzFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

  // Writes scene.EXTENSION and, after a line `%%`, the second files; and an image of light,
  // page.hdr, if the scene says that it has a lightmap. Returns the scene's path.
  std::filesystem::path write_scene(FuzzBytes bytes, const std::string& extension) const {
    const std::string_view all(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    const std::size_t cut = all.find("\n%%\n");
    if (cut != all.npos) {
      write("second.mtl", all.substr(cut + 4));
      write("second.bin", all.substr(cut + 4));
    }
    if (all.find("lightmap") != all.npos)
      write("page.hdr",
            "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 3\n" + std::string(24, '\x80'));
    return write("scene." + extension, all.substr(0, cut));
  }

  std::filesystem::path write(const std::string& name, std::string_view content) const {
    std::ofstream(path_ / name, std::ios::binary)
        .write(content.data(), std::streamsize(content.size()));
    return path_ / name;
  }

 private:
  std::filesystem::path path_;
};

// Chooses options.
inline unsigned sum_of(FuzzBytes bytes) {
  return std::accumulate(bytes.begin(), bytes.end(), 0u);
}

// Whether the message is what a user can use: one line with, in brackets, a remedy.
inline bool clear_error(const std::string& message) {
  return message.find('\n') == message.npos && message.find('(') != message.npos;
}

}  // namespace atlas::test
