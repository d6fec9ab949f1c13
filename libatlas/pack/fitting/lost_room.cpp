#include "libatlas/pack/fitting/lost_room.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "libatlas/core/parallel.h"
#include "libatlas/pack/outlines/outline_mask.h"

namespace atlas::pack {
namespace {

using Edges = std::span<const ChartOutline::Edge>;

// Calls visit(edges, area) for every loop. Holes have negative areas.
template <class Visit>
void each_loop(const ChartOutline& outline, Visit visit) {
  const Edges edges = outline.edges;
  double twice = 0;
  for (std::size_t k = 0, first = 0; k < edges.size(); ++k) {
    const Vec2d o = edges[first].from, a = edges[k].from, b = edges[k].to;
    twice += (a.x - o.x) * (b.y - o.y) - (a.y - o.y) * (b.x - o.x);
    if (k + 1 < edges.size() && edges[k + 1].from == b) continue;
    visit(edges.subspan(first, k + 1 - first), twice / 2);
    first = k + 1;
    twice = 0;
  }
}

double area_of(std::span<const ChartOutline> outlines) {
  return std::accumulate(outlines.begin(), outlines.end(), 0.0,
                         [](double sum, const ChartOutline& o) { return sum + o.area; });
}

// Ignores the outline's holes and returns the area that a morphological closing by squares of this
// side adds.
double closed_bays(const ChartOutline& outline, double width) {
  // A quarter of a cell; cells are 1/8 of the square's side.
  constexpr double kSpacing = 1.0 / 32;
  ChartOutline filled;
  double area = 0;
  each_loop(thinned(outline, kSpacing * width), [&](Edges loop, double loop_area) {
    if (!(loop_area > 0)) return;
    area += loop_area;
    filled.edges.insert(filled.edges.end(), loop.begin(), loop.end());
  });
  if (filled.edges.empty()) return 0;
  // A cell belongs to the mask if the chart is nearer to its centre than the padding plus half a
  // cell. That is a whole number of cells, which the erosion removes again without bias.
  constexpr std::int32_t kReach = 4, kCell = 2;
  RasterOptions raster;
  raster.cell = kCell;
  raster.padding = kReach * kCell - kCell / 2;
  raster.factor = 2 * kReach * kCell / width;
  Vec2d origin;
  Mask dilated = rasterize(filled, raster, origin);
  const auto eroded = [](Run run) { return Run{run.begin + kReach, run.end - kReach}; };
  Mask narrower = dilated;
  narrower.runs.clear();
  for (std::int32_t r = 0; r < dilated.height; ++r) {
    narrower.first[std::size_t(r)] = std::uint32_t(narrower.runs.size());
    for (const Run& run : dilated.row(r))
      if (const Run e = eroded(run); e.begin < e.end) narrower.runs.push_back(e);
  }
  narrower.first.back() = std::uint32_t(narrower.runs.size());
  double cells = 0;
  for (const Run& run : quarter_turn(narrower).runs) {
    const Run e = eroded(run);
    cells += std::max(0, e.end - e.begin);
  }
  // Along straight borders the rounding may be the same everywhere: up to one cell from side to
  // side.
  const double side = kCell / raster.factor;
  const Vec2d box = box_of(filled, 0);
  const double rounding = side * (box.x + box.y + side);
  return std::max(0.0, cells * side * side - area - rounding);
}

}  // namespace

double lost_to_holes(std::span<const ChartOutline> outlines) {
  constexpr double kSmall = 1.0 / 30;  // relative to the area of all charts
  const double all = area_of(outlines);
  double holes = 0, largest = 0;
  for (const ChartOutline& o : outlines)
    each_loop(o, [&](Edges, double area) {
      if (!(area < 0 && -area < kSmall * all)) return;
      holes -= area;
      largest = std::max(largest, -area);
    });
  for (const ChartOutline& o : outlines)
    if (o.area < largest) holes -= o.area;
  return std::max(0.0, holes);
}

double lost_to_bays(std::span<const ChartOutline> outlines, double gutter, const Context& context) {
  // Relative to the side of a square that all charts would fill.
  constexpr double kNarrow = 1.0 / 40;
  // Relative to a chart's longer side; so masks are no larger than pages.
  constexpr double kFinest = 1.0 / 1024;
  const double width = std::max(kNarrow * std::sqrt(area_of(outlines)), 4 * gutter);
  if (!(width > 0)) return 0;
  std::vector<double> bays(outlines.size());
  parallel_for(context, outlines.size(), 4, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Vec2d box = box_of(outlines[i], 0);
      const double finest = kFinest * std::max(box.x, box.y);
      bays[i] = std::min(box.x, box.y) < width ? -outlines[i].area
                                               : closed_bays(outlines[i], std::max(width, finest));
    }
  });
  return std::max(0.0, std::accumulate(bays.begin(), bays.end(), 0.0));
}

}  // namespace atlas::pack
