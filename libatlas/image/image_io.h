// Reads and writes image files. Rows are bottom-up in memory (core/image.h), and their order is
// reversed here. The first call for a file that is neither PNG nor JPEG loads a module that does
// the work; without the module, such calls return ErrorCode::unsupported. Other errors: not_found,
// io (the file is no image or is damaged), bad_input (the file claims a larger image than it can
// hold; the image to write is not as large as its sides say), unsupported (the image takes more
// than 4 GiB or is a volume), bad_option. Every function may be called from several threads at
// once.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "libatlas/core/image.h"
#include "libatlas/core/status.h"

namespace atlas {

// Loads the module. To be called before long work that ends with images other than PNG, so that the
// work is not in vain. `name` is the file that needs it, for the message. Errors: unsupported.
Status check_image_module(const std::string& name);

// Reads any format that OpenImageIO supports as 8-bit values, with all channels and without colour
// conversion (an sRGB file stays sRGB-encoded), except that CMYK becomes RGB. Colours are not
// multiplied by alpha: those that a TIFF says are so, and all of OpenEXR files with an alpha as
// their last channel, are divided by it, except where it is 0. Of OpenEXR files, the display window
// is read; texels of it that the file does not hold are 0.
Result<Image8> read_image8(const std::filesystem::path& path);

// The same for an encoded file (PNG, JPEG or WebP) in memory. Its bytes tell the format; `name` is
// for messages.
Result<Image8> decode_image8(std::span<const std::uint8_t> bytes, const std::string& name);

// The same as floats; integer values are scaled to [0, 1].
Result<ImageF> read_image_float(const std::filesystem::path& path);

// A texture for display or reflectance: colours are sRGB-encoded, the alpha of images with 2 or 4
// channels is not.
struct TextureImage {
  Image8 image = {};
  bool clipped = false;  // the file has colours beyond 0..1, or that are no numbers
};

// Reads an image as a texture. Files of integers hold sRGB-encoded colours, as read_image8() reads
// them. Files of floats (OpenEXR, Radiance HDR, some TIFF files) hold linear colours, which are
// encoded, and clipped to 0..1.
Result<TextureImage> read_texture(const std::filesystem::path& path);

struct PngOptions {
  int compression = 3;  // zlib level, 0 (none) to 9
  // For images such as baked pages, whose neighbouring texels are similar and in which nothing
  // repeats. Levels 1 to 5 then all do the same: they apply Paeth's filter and compress only runs.
  // Baked pages take less than half the time of level 3, and an eighth less space than it, about as
  // much as at level 6.
  bool smooth = false;
};

// Writes a PNG file with 1 to 4 channels, whatever the extension of `path` is. `path` is written
// directly; files/atomic_file.h makes files whole or absent.
Status write_png(const std::filesystem::path& path, const Image8& image, const PngOptions& options);

// Writes a ZIP-compressed OpenEXR file of scene-linear values: as half floats, or as floats if the
// image is too bright (a value above 65504) or too dark (no value above 0.006) for half floats.
// Values are written as they are: by the format, colours beside an alpha (of 2 or 4 channels) are
// multiplied by it.
Status write_exr(const std::filesystem::path& path, const ImageF& image);

}  // namespace atlas
