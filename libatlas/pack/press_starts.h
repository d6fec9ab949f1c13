// Internal: what the press begins with: charts as rigid bodies, and layouts of them on coarse
// cells.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "libatlas/pack/fit.h"
#include "libatlas/pack/nest.h"
#include "libatlas/pack/squeeze.h"

namespace atlas::pack {

// A chart in the frame of its mask at the scale that starts are made at: shape point p is at
// origin + scale p.
struct DrawnChart {
  enum Level { coarse, fine };
  Vec2d origin;
  Body bodies[2];  // by Level, with one centre

  // In texels from the shape's own origin.
  Vec2d center_of_shape() const {
    const Vec2d c = bodies[coarse].center;
    return {c.x - origin.x, c.y - origin.y};
  }
};

// One layout, to be pushed together.
struct PressStart {
  std::vector<std::pair<Vec2d, double>> poses;  // 1 a chart: centre and angle
  SqueezePage page;
  std::uint64_t layouts = 0, work = 0;
};

// The smaller such a page, the higher; 0 for one without area. Of a square one the longer side
// counts.
double goodness(const SqueezePage& page, const FitOptions& options);

// What is handed to it must outlive it.
class PressStarts {
 public:
  PressStarts(std::span<const ChartOutline> outlines, const FitOptions& options,
              const Context& context);

  double scale() const { return scale_; }
  std::span<const DrawnChart> charts() const { return drawn_; }  // 1 an outline

  // Layouts for several widths of the page, by a search on coarse cells; other ones each round, on
  // finer cells from the second on.
  std::vector<PressStart> make(std::uint32_t round);

 private:
  void draw();
  void draw_one(std::size_t i, int fine);
  void draw_pieces(int cells);
  std::int32_t strip_width(std::size_t k, std::size_t count, double shift) const;
  PressStart start(std::size_t k, std::size_t count, std::uint32_t round) const;
  PressStart alone() const;
  void put_down(const Nest& nest, PressStart& start) const;

  std::span<const ChartOutline> outlines_;
  const FitOptions& options_;
  const Context& context_;
  double scale_ = 1;
  double side_ = 0;  // of a square page, texels, that the charts as drawn fill as well as hoped for
  int cells_ = 0;    // across the page, as the pieces are drawn; 0: not yet
  std::int32_t cell_ = 1;
  std::vector<DrawnChart> drawn_;
  std::vector<Piece> pieces_;
};

}  // namespace atlas::pack
