// Pages that hold the light itself, for .html.
#pragma once

#include <filesystem>

#include "libatlas/core/image.h"
#include "libatlas/core/status.h"

namespace atlas {

// Writes an image of RGB light, scene-linear, as a file in zlib's format of these bytes:
//   - width and height, as little-endian 32-bit integers;
//   - a little-endian float: `top`, the base-2 logarithm of the luma that code 65535 stands for;
//   - four planes of width * height bytes, rows from the bottom: the low and the high bytes of the
//     codes, then the shares of red and of blue in R + G + B, as 255ths.
// A code c > 0 is the luma (Rec. 709 weights) 2^(top + (c - 65535) / 256): it is off by at most
// 0.14 %, over 256 octaves. Code 0 is no light. What is stored of codes and shares is the
// difference from what the left, the lower and the lower left neighbour predict (PNG's Paeth;
// beyond the border they are 0), modulo 65536 or 256; that of codes with the sign in its lowest
// bit: 0, -1, 1, -2 ... are 0, 1, 2, 3. Channels below 0 count as 0. Errors: io; bad_input (not
// three channels); unsupported (no memory).
Status write_light_page(const std::filesystem::path& path, const ImageF& light);

}  // namespace atlas
