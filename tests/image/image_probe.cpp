// Says why no image can be read. It is a separate process because the module is looked for only
// once.
#include <cstdio>

#include "libatlas/image/image_io.h"

int main(int, char** argument) {
  const auto image = atlas::read_image8(argument[1]);
  std::puts(image.ok() ? "read" : image.status().message().c_str());
}
