// Image files in and out. Rows are bottom-up in memory (core/image.h) and turned here. The first
// call loads the module that does it; without the module every call returns ErrorCode::unsupported.
// Errors besides: not_found, io, bad_input (what is read is no image, or more than its file can
// hold; what is to be written is not as large as its sizes say), bad_option. Every function may be
// called from several threads at once.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "libatlas/core/image.h"
#include "libatlas/core/status.h"

namespace atlas {

// Reads any format that OpenImageIO knows as 8-bit values, all channels, without any colour
// conversion (an sRGB file stays sRGB-encoded).
Result<Image8> read_image8(const std::filesystem::path& path);

// The same for an encoded file held in memory; `name` is for messages, the format is found out
// from the bytes.
Result<Image8> decode_image8(std::span<const std::uint8_t> bytes, const std::string& name);

// The same as floats; integer files are scaled to [0, 1].
Result<ImageF> read_image_float(const std::filesystem::path& path);

struct PngOptions {
  int compression = 3;  // zlib level, 0 (none) to 9
  // Neighbouring texels are much alike and nothing repeats, as on baked pages: levels 1 to 5 then
  // are one, which looks for runs only, after Paeth's filter. Baked pages take less than half the
  // time and an eighth less room than at level 3, about those of level 6.
  bool smooth = false;
};

// Writes a 1 to 4 channel PNG. `path` is written directly: see core/atomic_file.h for
// whole-or-absent.
Status write_png(const std::filesystem::path& path, const Image8& image, const PngOptions& options);

// Writes a ZIP-compressed OpenEXR file of scene-linear values: half floats, or floats where the
// image is brighter (above 65504) or darker (nothing above 0.006) than halves can tell.
Status write_exr(const std::filesystem::path& path, const ImageF& image);

}  // namespace atlas
