// Internal: the starting points of pressing: charts as rigid bodies, and layouts of them on coarse
// cells.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "libatlas/pack/nesting/nest.h"
#include "libatlas/pack/pressing/fit_search_options.h"
#include "libatlas/pack/pressing/squeeze.h"

namespace atlas::pack {

// A chart in the frame of its mask, at the scale of the starts: the shape's point p lies at origin
// + scale p.
struct DrawnChart {
  enum Level { coarse, fine };
  Vec2d origin;
  Body bodies[2];  // by Level; both have the same centre

  // Returns the centre in texels from the shape's own origin.
  Vec2d center_of_shape() const {
    const Vec2d c = bodies[coarse].center;
    return {c.x - origin.x, c.y - origin.y};
  }
};

// A layout whose charts are to be pushed together.
struct PressStart {
  std::vector<std::pair<Vec2d, double>> poses;  // one per chart: centre and angle
  SqueezePage page;
  std::uint64_t layouts = 0;
};

// Returns a number that is higher the smaller the page is; 0 for a page without area. If the page
// has to be square, only its longer side counts.
double goodness(const SqueezePage& page, const FitOptions& options);

// All arguments of the constructor must outlive the object.
class PressStarts {
 public:
  PressStarts(std::span<const ChartOutline> outlines, const FitSearchOptions& options,
              const Context& context);

  double scale() const { return scale_; }
  std::span<const DrawnChart> charts() const { return drawn_; }  // one per outline

  // Makes layouts for several widths of the page, by a search on coarse cells, with this share of
  // round_work(). Each round gives other layouts. From the second round on, cells are finer.
  std::vector<PressStart> make(std::uint32_t round, double share);

  // Returns the scale that charts have if this page is enlarged to a square page of full size.
  double scale_on_page(const SqueezePage& page) const;

 private:
  void draw();
  void draw_one(std::size_t i, int fine);
  void draw_pieces(int cells);
  std::int32_t strip_width(std::size_t k, std::size_t count, double shift) const;
  // A start whose layout is still searched for on a strip of this width in cells.
  struct Runner {
    NestSearch search;
    std::int32_t width;
    std::uint64_t seed;
    PressStart start;
  };
  Runner runner(std::size_t k, std::size_t count, std::uint32_t round, double work) const;
  void race(std::vector<Runner>& runners, std::uint32_t round) const;
  void run(std::vector<Runner*>& runners, double share) const;
  void lower_fullest(std::vector<Runner>& runners, double share) const;
  void note(const NestSearchResult& found, Runner& runner) const;
  void take(const Nest& nest, Runner& runner) const;
  PressStart alone() const;
  void put_down(const Nest& nest, PressStart& start) const;

  std::span<const ChartOutline> outlines_;
  const FitSearchOptions& options_;
  const Context& context_;
  double scale_ = 1;
  // Side in texels of a square page that the charts, as rasterised, fill to the expected share.
  double side_ = 0;
  // Cells across the page with which the pieces are rasterised; 0: not rasterised yet.
  int cells_ = 0;
  std::int32_t cell_ = 1;
  std::vector<DrawnChart> drawn_;
  std::vector<Piece> pieces_;
};

}  // namespace atlas::pack
