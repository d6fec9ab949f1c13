// Internal: an image file that is being read, for the readers of single formats.
#pragma once

#include <cstdint>
#include <cstdio>
#include <string>

namespace atlas {

// Bytes of a file on disk or in memory (fmemopen), at their beginning.
struct EncodedImage {
  std::FILE* file = nullptr;
  std::uint64_t bytes = 0;  // size of the file
  std::string name = {};    // for messages
};

}  // namespace atlas
