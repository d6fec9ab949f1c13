// Internal: what the module that reads and writes image files gives to image_io.cpp.
//
// OpenImageIO brings some 250 shared libraries and 115 MiB with it, and takes longer to load than a
// small mesh to cut into charts. Few runs see an image file, so what needs OpenImageIO is a module
// of its own, which is loaded when the first image is asked for.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "libatlas/image/image_io.h"

namespace atlas {

// The functions of image_io.h, name for name.
struct ImageFiles {
  Result<Image8> (*read_image8)(const std::filesystem::path&);
  Result<Image8> (*decode_image8)(std::span<const std::uint8_t>, const std::string&);
  Result<ImageF> (*read_image_float)(const std::filesystem::path&);
  Status (*write_png)(const std::filesystem::path&, const Image8&, const PngOptions&);
  Status (*write_exr)(const std::filesystem::path&, const ImageF&);
};

}  // namespace atlas

// The module's one entry.
extern "C" const atlas::ImageFiles* libatlas_image_files();
