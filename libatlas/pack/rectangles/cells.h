// Internal: conversion between texels and the whole cells in which the engines work.
#pragma once

#include <algorithm>

#include "libatlas/pack/pack.h"

namespace atlas::pack {

// Maps the user's texels to the packer's cells. An item, with its padding to the right and above,
// takes whole cells. The page gains one padding, since none is needed at its far edges.
class AlignedCells {
 public:
  explicit AlignedCells(const PackOptions& o) : options_(o) {
    origin_ = (o.border + o.alignment - 1) / o.alignment * o.alignment;
  }

  std::int64_t item(std::int64_t side) const {
    return (side + options_.padding + options_.alignment - 1) / options_.alignment;
  }
  // Returns the number of cells along a page side; 0 if nothing fits.
  std::int32_t page(std::int64_t side) const {
    const std::int64_t inner = side - options_.border - origin_ + options_.padding;
    return static_cast<std::int32_t>(std::max<std::int64_t>(0, inner / options_.alignment));
  }
  std::int32_t texel(std::int32_t cell) const { return origin_ + cell * options_.alignment; }
  std::int32_t cell(std::int32_t texel) const { return (texel - origin_) / options_.alignment; }
  std::int32_t corner() const { return origin_; }
  // Returns whether the corner lies on a page of this size and not on its far border.
  bool has_corner(Extent page) const {
    const std::int64_t least = std::int64_t{origin_} + options_.border;
    return (page.width == 0 || page.width >= least) && (page.height == 0 || page.height >= least);
  }

  // Returns the cells that a pinned rectangle and the padding around it keep free of other items.
  Rect pinned(const Rect& r, Extent page_cells) const {
    const std::int64_t a = options_.alignment, p = options_.padding;
    const auto down = [&](std::int64_t v) { return v >= 0 ? v / a : -((-v + a - 1) / a); };
    const auto cut = [](std::int64_t v, std::int32_t high) {
      return static_cast<std::int32_t>(std::clamp<std::int64_t>(v, 0, high));
    };
    const std::int32_t x0 = cut(down(std::int64_t{r.x} - origin_), page_cells.width);
    const std::int32_t y0 = cut(down(std::int64_t{r.y} - origin_), page_cells.height);
    const std::int64_t right = std::int64_t{r.x} + r.width + p - origin_;
    const std::int64_t top = std::int64_t{r.y} + r.height + p - origin_;
    const std::int32_t x1 = cut(down(right + a - 1), page_cells.width);
    const std::int32_t y1 = cut(down(top + a - 1), page_cells.height);
    return {x0, y0, std::max(0, x1 - x0), std::max(0, y1 - y0)};
  }

 private:
  const PackOptions& options_;
  std::int32_t origin_ = 0;
};

}  // namespace atlas::pack
