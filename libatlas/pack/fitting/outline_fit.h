// Internal: lays charts out on pages at one scale, for the search for the largest scale.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "libatlas/pack/fit.h"
#include "libatlas/pack/fitting/fit_bounds.h"
#include "libatlas/pack/nesting/grid_choice.h"
#include "libatlas/pack/nesting/nest.h"
#include "libatlas/pack/outlines/chart_outline.h"
#include "libatlas/pack/pressing/fit_search_options.h"

namespace atlas::pack {

struct OutlineLayout {
  double scale = 0;           // the common scale; 0: there is no layout
  std::vector<Piece> pieces;  // one per chart, as rasterised
  // One per piece: its scale, which is larger than the common one if a minimum side demands it.
  std::vector<double> factors;
  std::vector<std::uint32_t> page;  // one per piece
  std::vector<NestPlace> places;    // one per piece
  std::vector<Extent> page_sizes;   // in cells
  std::uint64_t layouts = 0;        // layouts tried on all pages
  GroupingResult grouping;
};

// All arguments of the constructor must outlive the object.
class OutlineFit {
 public:
  OutlineFit(std::span<const FitItem> items, std::span<const ChartOutline> outlines,
             const FitSearchOptions& options, const Context& context);

  double area() const { return area_; }
  const ChartOutline& outline(std::size_t chart) const { return outlines_[chart]; }
  const GridChoice& grid() const { return grid_; }
  std::int32_t side() const { return side_; }
  const FitSearchOptions& options() const { return options_; }
  const Context& context() const { return context_; }

  FitBounds bounds() const;

  // Sets the order in which pages are filled from now on. At first it is by cells.
  void place(LargestBy by) { by_ = by; }

  // Returns the share of all pages that the masks take at this scale. The masks are rasterised for
  // it, but not packed.
  double share(double scale) const;

  // Lays out all charts on this many pages at this scale. Returns false if they find no room. The
  // groups of F(A) = N are tried first. They are balanced by area, but the first groups hold the
  // few largest charts and nothing that fills the gaps between them. If the groups fail, the charts
  // are dealt out such that every page gets large and small ones. The scale at which the groups
  // failed is remembered, and they are not tried again at this scale or above.
  bool pack_at(double scale, std::uint32_t pages, OutlineLayout& layout);

  // Packs the charts of each page again into the smallest page size that holds them.
  void shrink_pages(OutlineLayout& layout) const;

 private:
  // Whether the search has been cancelled or its time is up. Pages are left unfinished then.
  bool over() const;

  // Rasterises the pieces.
  void prepare(double scale, OutlineLayout& layout) const;

  // Packs every page with the charts that layout.page assigns to it. The charts that find no room
  // move to other pages.
  bool pack_pages(std::uint32_t pages, OutlineLayout& layout) const;

  std::int64_t cells_of_pages(std::uint32_t pages) const;
  static std::int64_t cells_of(std::span<const Piece> pieces);
  // Returns false if the pieces' cells alone exceed the pages.
  bool group(std::uint32_t pages, OutlineLayout& layout) const;

  // Returns the limits of the search over orders for one page.
  NestSearchOptions search_of(std::size_t page) const;

  // Packs these charts, which come largest first, into page p.
  NestSearchResult fill_group(std::span<const Piece> pieces, std::size_t p) const;

  // Puts charts that found no room in their group's page into the first page that has room, largest
  // first.
  bool place_left_over(std::vector<std::uint32_t> left, OutlineLayout& layout) const;

  std::span<const FitItem> items_;
  std::span<const ChartOutline> outlines_;
  const FitSearchOptions& options_;
  const Context& context_;
  GridChoice grid_;
  std::int32_t side_ = 0;
  double area_ = 0;
  LargestBy by_ = LargestBy::cells;
  double groups_fail_at_ = std::numeric_limits<double>::infinity();
};

}  // namespace atlas::pack
