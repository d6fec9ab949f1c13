// Internal: the interface of the module that reads and writes image files of all formats but PNG
// and JPEG, for image_io.cpp.
//
// OpenImageIO brings some 250 shared libraries and 115 MiB with it, and loading it takes longer
// than cutting a small mesh into charts. Few runs read or write files of other formats, so the code
// that needs OpenImageIO is a module of its own, which is loaded for the first of them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "libatlas/image/image_io.h"

namespace atlas {

// Functions of image_io.h, by the same names, and what those need.
struct ImageFiles {
  // The value of image_files_mark() where the module was compiled. It must stay the first member,
  // so that it can be read whatever the other members are.
  std::uint64_t mark;
  Result<Image8> (*read_image8)(const std::filesystem::path&);
  Result<Image8> (*decode_webp8)(std::span<const std::uint8_t>, const std::string&);
  Result<ImageF> (*read_image_float)(const std::filesystem::path&);
  // Returns whether a file holds floats; false if it cannot be read.
  bool (*holds_floats)(const std::filesystem::path&);
  Status (*write_exr)(const std::filesystem::path&, const ImageF&);
};

// The library and the module pass C++ objects to each other, so they must have been compiled alike.
// The mark differs if the sizes of those objects differ. Increase kVersion when the functions
// change.
constexpr std::uint64_t image_files_mark() {
  constexpr std::uint64_t kVersion = 3;
  std::uint64_t mark = 0x9e3779b97f4a7c15u + kVersion;  // no function has such an address
  for (const std::uint64_t size :
       {sizeof(ImageFiles), sizeof(std::filesystem::path), sizeof(std::string), sizeof(Image8),
        sizeof(ImageF), sizeof(Status), sizeof(Result<Image8>)})
    mark = (mark ^ size) * 0x100000001b3u;  // FNV-1a
  return mark;
}

}  // namespace atlas

// The module's only entry point.
extern "C" const atlas::ImageFiles* libatlas_image_files();
