// Internal: counts materials of one kind and describes them in a line of text.
#pragma once

#include <fmt/format.h>

#include <cstddef>
#include <string>

#include "libatlas/core/counted.h"
#include "libatlas/scene/scene.h"

namespace atlas {

// The number of materials, and the first one's name.
struct NamedMaterials {
  std::size_t count = 0;
  std::string first;

  void add(const Material& material) {
    if (count++ == 0) first = material.name;
  }
  std::string text() const {
    return fmt::format("{} ('{}'{})", counted(count, "material"), first, count == 1 ? "" : ", ...");
  }
};

}  // namespace atlas
