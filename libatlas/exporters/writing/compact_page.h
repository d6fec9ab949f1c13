// Internal: Compactor, which numbers the vertices of a page by themselves.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/core/no_index.h"

namespace atlas {

// Renumbers index lists by first use, one list after the other, with the memory of a single table.
class Compactor {
 public:
  explicit Compactor(std::size_t count) : to_(count, kNoIndex) {}

  struct Compact {
    std::vector<std::uint32_t> used;     // old index of each new one
    std::vector<std::uint32_t> indices;  // new indices
  };

  Compact compact(std::span<const std::uint32_t> indices) {
    Compact result;
    result.indices.reserve(indices.size());
    for (const std::uint32_t i : indices) {
      if (to_[i] == kNoIndex) {
        to_[i] = static_cast<std::uint32_t>(result.used.size());
        result.used.push_back(i);
      }
      result.indices.push_back(to_[i]);
    }
    for (const std::uint32_t i : result.used) to_[i] = kNoIndex;
    return result;
  }

 private:
  std::vector<std::uint32_t> to_;
};

}  // namespace atlas
