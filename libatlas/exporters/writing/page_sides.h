// Internal: the triangles of a page by how they are seen.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/exporters/world.h"

namespace atlas {

// Divides a page into the triangles that are seen from both sides and those that are seen from
// their front only. The page must outlive this object.
class PageSides {
 public:
  explicit PageSides(const Page& page);
  PageSides(const PageSides&) = delete;
  PageSides& operator=(const PageSides&) = delete;

  struct Side {
    std::span<const std::uint32_t> indices, uv_indices;  // as in Page
    bool one_sided = false;
  };
  // Returns one or two sides with triangles, first those that are seen from both sides. In each,
  // the triangles have the order of the page.
  std::span<const Side> sides() const { return sides_; }

 private:
  std::vector<std::uint32_t> indices_[2], uv_indices_[2];  // empty if all triangles are alike
  std::vector<Side> sides_;
};

}  // namespace atlas
