// Internal: packs boxes on pages at one scale, to solve a fit without outlines.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/pack/fit.h"
#include "libatlas/pack/rectangles/engines.h"
#include "libatlas/pack/rectangles/problem.h"

namespace atlas::pack {

struct BoxLayout {
  std::vector<Placement> placements;  // one per item, in cells
  std::uint32_t pages = 0;
  GroupingResult grouping;
};

// Boxes are measured in cells of alignment × alignment texels, padding included.
class BoxFit {
 public:
  BoxFit(std::span<const FitItem> items, const FitOptions& options, const Context& context);

  void make_boxes(double scale);
  double box_area(double scale);  // in cells; also makes the boxes
  bool may_fit(double scale);     // checks necessary conditions only; also makes the boxes
  // At smaller scales the boxes stay the same: they have their minimum sides.
  double least_scale() const;
  bool pack_at(double scale, std::uint32_t pages, BoxLayout& layout);
  Extent shrink_page(std::uint32_t page, BoxLayout& layout) const;

  const std::vector<Extent>& boxes() const { return boxes_; }
  const std::vector<Extent>& contents() const { return contents_; }
  const FitOptions& options() const { return options_; }
  const Context& context() const { return context_; }
  Extent page() const { return page_; }

 private:
  bool box_fits_page(const Extent& box) const;
  bool group(std::uint32_t pages, BoxLayout& layout) const;
  Problem problem_of(std::span<const Extent> items, Extent page, std::uint32_t max_pages) const;
  bool pack_many(BoxLayout& layout) const;
  bool pack_grouped(std::uint32_t pages, BoxLayout& layout);
  bool pack_jointly(std::uint32_t pages, BoxLayout& layout);
  bool pack_searched(std::uint32_t pages, BoxLayout& layout);
  bool keep(Layout found, BoxLayout& layout) const;
  bool place(std::uint32_t item, std::uint32_t page, FreeRects& free, BoxLayout& layout) const;

  std::span<const FitItem> items_;
  const FitOptions& options_;
  const Context& context_;
  Extent page_;
  std::vector<Extent> contents_, boxes_;
};

}  // namespace atlas::pack
