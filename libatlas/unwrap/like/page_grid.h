// Internal: triangles on pages, found by their place.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "libatlas/core/vec.h"
#include "libatlas/pack/pack.h"

namespace atlas {

using TexelCorners = std::array<Vec2d, 3>;  // counter-clockwise

// Twice the area of a triangle; negative where it runs clockwise.
double twice_area(const TexelCorners& t);

class PageGrid {
 public:
  // For about so many triangles.
  PageGrid(std::span<const Extent> pages, std::size_t triangles);

  struct Place {
    std::uint32_t page = 0;
    TexelCorners corners = {};
  };
  // Adds a triangle that belongs to `owner`. Returns its number.
  std::uint32_t add(const Place& place, std::uint32_t owner);
  void remove(std::uint32_t number) { entries_[number].alive = false; }

  // Returns whether a triangle comes nearer to one of those added than the gap that `gap` gives for
  // its owner, in texels. A gap below 0 lets triangles overlap by so much. Near corners, triangles
  // that are up to a gap's length farther away may count, too.
  bool meets(const Place& place, const std::function<double(std::uint32_t owner)>& gap,
             double most_gap) const;

 private:
  struct Entry {
    TexelCorners corners;
    std::uint32_t owner;
    bool alive;
  };
  struct Node {
    std::uint32_t entry, next;
  };
  struct Page {
    double cell = 1;  // texels
    std::int32_t columns = 1, rows = 1;
    std::vector<std::uint32_t> first;  // one per cell: a node
  };
  template <class Visit>
  static bool visit_cells(const Page& page, const TexelCorners& corners, double reach,
                          const Visit& visit);

  std::vector<Page> pages_;
  std::vector<Entry> entries_;
  std::vector<Node> nodes_;
};

}  // namespace atlas
