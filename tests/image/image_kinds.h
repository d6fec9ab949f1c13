// PNG and JPEG files of every kind, for tests of their readers. The texels are noise that is the
// same in every run.
#pragma once

#include <string>
#include <vector>

namespace atlas::test {

struct ImageOfKind {
  std::string kind, bytes;
};

// All colour types, depths, and interlacing, with and without transparent colours; what files say
// about gamma, significant bits, background and place; sides of one texel; every 16-bit value.
std::vector<ImageOfKind> png_kinds();

// Grey, RGB with full and halved colours, stored as YCbCr or RGB, CMYK, YCCK and two channels, each
// baseline and progressive; restarts; an Exif orientation; sides of one texel.
std::vector<ImageOfKind> jpeg_kinds();

// A progressive JPEG whose last scan is there this many times.
std::string jpeg_of_scans(int scans);

}  // namespace atlas::test
