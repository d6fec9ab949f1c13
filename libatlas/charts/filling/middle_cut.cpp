#include "libatlas/charts/filling/middle_cut.h"

#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "libatlas/charts/filling/chords.h"
#include "libatlas/charts/filling/line_cut.h"
#include "libatlas/core/hull.h"

namespace atlas {
namespace {

constexpr int kDirections = 4;  // over half a turn, from u, the chart's long side
constexpr std::array<double, 3> kPlaces{0.5, 0.33, 0.67};  // along the piece, the middle first
constexpr double kMiddleBand = 0.15;                       // as a share of its length

// Returns the sprawl of these triangles. Only corners on boundary loops are used; those of holes do
// no harm.
double sprawl_of(const FlatChart& chart, const param::HalfEdges& half_edges,
                 std::span<const std::uint32_t> triangles, std::vector<std::uint8_t>& belongs) {
  for (const std::uint32_t t : triangles) belongs[t] = 1;
  std::vector<Vec2d> points, hull;
  for (const std::uint32_t t : triangles) {
    for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
      const std::uint32_t o = half_edges.opposite(h);
      if (o == kNoIndex || !belongs[o / 3]) points.push_back(chart.uvs[half_edges.from(h)]);
    }
  }
  for (const std::uint32_t t : triangles) belongs[t] = 0;
  const double area = hull_area(points, hull);
  return sprawl(area, box_area(hull));
}

}  // namespace

MiddleCut cut_middle(const FlatChart& chart, const param::HalfEdges& half_edges,
                     std::span<const std::uint32_t> triangles, const MiddleCutLimits& limits) {
  LineCutter cutter(chart, half_edges, triangles, limits.polygons);
  std::vector<std::uint8_t> belongs(chart.triangles.size(), 0);
  const double whole = sprawl_of(chart, half_edges, triangles, belongs);
  MiddleCut best, middle;
  for (int i = 0; i < kDirections; ++i) {
    cutter.face(std::numbers::pi * i / kDirections);
    const double extent = cutter.high() - cutter.low();
    for (const double place : kPlaces) {
      if (limits.context && limits.context->cancelled()) return middle;
      LineCut made = cutter.cut(cutter.low() + place * extent, kMiddleBand * extent, limits.crumb);
      if (made.parts.empty()) continue;
      MiddleCut cut{{}, whole, made.length};
      for (LineCut::Part& part : made.parts) {
        cut.fall -= sprawl_of(chart, half_edges, part.triangles, belongs);
        cut.parts.push_back(std::move(part.triangles));
      }
      if (cut.fall >= limits.least_fall && cut.fall * best.length >= best.fall * cut.length) {
        best = cut;
      }
      const bool shorter = middle.parts.empty() || cut.length < middle.length;
      if (place == kPlaces[0] && shorter) middle = std::move(cut);
    }
  }
  return best.parts.empty() ? middle : best;
}

}  // namespace atlas
