// Internal: reads JPEG files by libjpeg, for image_io.cpp.
#pragma once

#include "libatlas/core/image.h"
#include "libatlas/core/status.h"
#include "libatlas/image/encoded_image.h"

namespace atlas {

// As the functions of image_io.h. Grey stays one channel, and CMYK becomes RGB. The image is not
// turned, whatever orientation its Exif data state.
Result<Image8> read_jpeg8(const EncodedImage& source);
Result<ImageF> read_jpeg_float(const EncodedImage& source);

}  // namespace atlas
