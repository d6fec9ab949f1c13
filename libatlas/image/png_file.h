// Internal: reads and writes PNG files by libpng, for image_io.cpp.
#pragma once

#include <cstdio>
#include <string>

#include "libatlas/core/image.h"
#include "libatlas/core/status.h"
#include "libatlas/image/encoded_image.h"
#include "libatlas/image/image_io.h"

namespace atlas {

// As the functions of image_io.h. Palettes become colours, greys of less than 8 bits 8-bit values,
// and colours that the file declares transparent an alpha channel. Values are not changed by what
// the file says about colour spaces.
Result<Image8> read_png8(const EncodedImage& source);
Result<ImageF> read_png_float(const EncodedImage& source);

// Writes to an open file. `name` is for messages. Errors: io.
Status encode_png(std::FILE* file, const std::string& name, const Image8& image,
                  const PngOptions& options);

}  // namespace atlas
