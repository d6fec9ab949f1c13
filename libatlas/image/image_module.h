// Internal: loads the module that reads and writes image files (image_files.h).
#pragma once

#include <string>

#include "libatlas/image/image_files.h"

namespace atlas {

struct ImageModule {
  const ImageFiles* functions = nullptr;  // null if there is no module
  std::string why_not = {};               // the reason then
};

// Returns the module. It is loaded by the first call, and never unloaded, because OpenImageIO has
// threads.
const ImageModule& image_module();

}  // namespace atlas
