// Internal: charts laid out on pages at one scale, for the search of the largest.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "libatlas/pack/chart_outline.h"
#include "libatlas/pack/fit.h"
#include "libatlas/pack/fit_bounds.h"
#include "libatlas/pack/nest.h"
#include "libatlas/pack/shape_check.h"

namespace atlas::pack {

struct OutlineLayout {
  double scale = 0;                 // common; 0: none
  std::vector<Piece> pieces;        // 1 a chart, as drawn
  std::vector<double> factors;      // 1 a piece: its scale, larger where a minimum side asks for it
  std::vector<std::uint32_t> page;  // 1 a piece
  std::vector<NestPlace> places;    // 1 a piece
  std::vector<Extent> page_sizes;   // cells
  std::uint32_t moved = 0;          // pieces that left their group's page
  std::uint64_t layouts = 0;        // tried, of all pages
  GroupingResult grouping;
};

// Everything handed to it must outlive it.
class OutlineFit {
 public:
  OutlineFit(std::span<const FitItem> items, std::span<const ChartOutline> outlines,
             const FitOptions& options, const Context& context);

  double area() const { return area_; }
  const ChartOutline& outline(std::size_t chart) const { return outlines_[chart]; }
  const GridChoice& grid() const { return grid_; }
  std::int32_t side() const { return side_; }
  const FitOptions& options() const { return options_; }
  const Context& context() const { return context_; }

  FitBounds bounds() const;

  // In which order pages are filled from now on; at first by cells.
  void place(LargestBy by) { by_ = by; }

  // From now on few other orders are searched where that one fails.
  void search_little() { search_little_ = true; }

  // Of all pages, that masks take at this scale: found by drawing them, without packing.
  double share(double scale) const;

  // Lays all charts out on so many pages at this scale; false where they find no room. First with
  // the groups of F(A) = N. They are balanced by area, but the first ones hold the few
  // largest charts and nothing to fill the gaps with; where they fail, charts are dealt out such
  // that every page gets large and small ones. A scale at which the groups failed is remembered:
  // above it they are not tried again.
  bool pack_at(double scale, std::uint32_t pages, OutlineLayout& layout);

  // Packs the charts of one page again into the smallest page size that holds them.
  void shrink_page(std::uint32_t page, OutlineLayout& layout) const;

 private:
  // Draws the pieces.
  void prepare(double scale, OutlineLayout& layout) const;

  // Largest first, each to the page with the least in it.
  void deal_out(std::uint32_t pages, OutlineLayout& layout) const;

  // Packs every page with the charts that layout.page gives it; what is left over moves.
  bool pack_pages(std::uint32_t pages, OutlineLayout& layout) const;

  std::int64_t cells_of_pages(std::uint32_t pages) const;
  static std::int64_t cells_of(std::span<const Piece> pieces);
  // False if the pieces' cells alone exceed the pages.
  bool group(std::uint32_t pages, OutlineLayout& layout) const;

  // How long orders are searched for one page. An effort is shared by the packings.
  NestSearchOptions search_of(std::size_t page) const;

  // Page p gets the charts orders[p], largest first.
  NestSearchResult fill_group(std::span<const Piece> pieces,
                              std::span<const std::vector<std::uint32_t>> orders, std::size_t p,
                              BitPage& page) const;

  // Charts without room in their group's page go to the first page that has some, largest first.
  bool place_left_over(std::vector<std::uint32_t> left, std::vector<BitPage>& open,
                       OutlineLayout& layout) const;

  std::span<const FitItem> items_;
  std::span<const ChartOutline> outlines_;
  const FitOptions& options_;
  const Context& context_;
  GridChoice grid_;
  std::int32_t side_ = 0;
  double area_ = 0;
  LargestBy by_ = LargestBy::cells;
  bool search_little_ = false;
  double groups_fail_at_ = std::numeric_limits<double>::infinity();
};

}  // namespace atlas::pack
