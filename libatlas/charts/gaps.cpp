#include "libatlas/charts/gaps.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "libatlas/charts/chart_set_check.h"
#include "libatlas/charts/chart_triangles.h"
#include "libatlas/charts/totals.h"
#include "libatlas/core/parallel.h"
#include "libatlas/param/mesh/halfedges.h"
#include "libatlas/param/orient.h"
#include "libatlas/param/repair/widen.h"

namespace atlas {
namespace {

// Relative to the square root of a chart's area, as in flattening.
constexpr double kMinAltitude = 1e-7;

// The largest clearance, relative to the square root of a chart's area. With more, every place of
// the border is close to another one, and moving it that far would tear the chart up.
constexpr double kWidest = 0.2;

// A chart as a mesh of its own, without the triangles that cover nothing.
struct Flat {
  std::vector<Vec3f> positions;
  std::vector<std::array<std::uint32_t, 3>> corners;
  std::vector<double> density;
  std::vector<Vec2d> uvs;

  LocalMesh mesh() const { return {PositionView(positions, positions[0]), corners, density}; }
};

Flat flat_chart(const MeshView& mesh, const ChartSet& set, const Chart& chart) {
  Flat flat;
  const auto& opposite = set.flipped_triangles;
  for (std::uint32_t i = chart.first_uv; i < chart.first_uv + chart.uv_count; ++i) {
    flat.positions.push_back(mesh.positions[set.uv_vertex[i]]);
    flat.uvs.push_back(set.uvs[i]);
  }
  for (std::uint32_t i = 0; i < chart.triangle_count; ++i) {
    const std::uint32_t t = set.chart_triangles[chart.first_triangle + i];
    const std::uint32_t* const uv = &set.triangle_uv[3 * std::size_t{t}];
    std::array<std::uint32_t, 3> c{uv[0], uv[1], uv[2]};
    if (c[0] == c[1] || c[1] == c[2] || c[2] == c[0]) continue;
    if (std::binary_search(opposite.begin(), opposite.end(), t)) std::swap(c[1], c[2]);
    c = from_lowest(c);
    for (std::uint32_t& corner : c) corner -= chart.first_uv;
    flat.corners.push_back(c);
    if (!mesh.density.empty()) flat.density.push_back(mesh.density[t]);
  }
  return flat;
}

Widened widen(const MeshView& mesh, const WidenOptions& options, ChartSet& set, Chart& chart) {
  Flat flat = flat_chart(mesh, set, chart);
  if (flat.corners.empty()) return {};
  const Widened widened = widen_mesh_gaps(flat.mesh(), options, flat.uvs);
  if (!widened.moved) return widened;
  const double scale = area_preserving_scale(widened.distortion);
  for (Vec2d& p : flat.uvs) p = {scale * p.x, scale * p.y};
  chart.distortion = widened.distortion;
  chart.distortion.uv_area *= scale * scale;
  const auto border = param::border_edges(flat.corners, flat.uvs.size());
  chart.size = orient_for_packing(flat.uvs, border).size;
  std::copy(flat.uvs.begin(), flat.uvs.end(), set.uvs.begin() + chart.first_uv);
  return widened;
}

Status check(const MeshView& mesh, std::span<const double> clearance, const ChartSet& charts) {
  if (clearance.size() != charts.charts.size())
    return {ErrorCode::bad_input, fmt::format("gaps: {} clearances for {} charts", clearance.size(),
                                              charts.charts.size())};
  for (std::size_t c = 0; c < clearance.size(); ++c) {
    if (!(clearance[c] >= 0))
      return {ErrorCode::bad_input,
              fmt::format("gaps: the clearance of chart {} is {} (at least 0)", c, clearance[c])};
  }
  return check_chart_set(mesh, charts, "gaps");
}

// Calls look(c) for every chart that has a clearance and is large enough for it. Returns the sums
// of the results.
template <class Look>
GapReport look_at_all(const ChartSet& charts, std::span<const double> clearance,
                      const Context& context, const Look& look) {
  std::vector<Widened> found(clearance.size());
  parallel_for(context, found.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c) {
      const double most = kWidest * std::sqrt(charts.charts[c].distortion.uv_area);
      if (clearance[c] > 0 && clearance[c] <= most) found[c] = look(c);
    }
  });
  GapReport report;
  for (std::size_t c = 0; c < found.size(); ++c) {
    if (!(clearance[c] > 0)) continue;
    report.charts += found[c].moved;
    report.border += found[c].border / clearance[c];
    report.near_before += found[c].near_before / clearance[c];
    report.near_after += found[c].near_after / clearance[c];
  }
  return report;
}

}  // namespace

Result<GapReport> measure_gaps(const MeshView& mesh, std::span<const double> clearance,
                               const ChartSet& charts, const Context& context) {
  if (Status s = check(mesh, clearance, charts); !s.ok()) return s;
  const GapReport report = look_at_all(charts, clearance, context, [&](std::size_t c) {
    const Flat flat = flat_chart(mesh, charts, charts.charts[c]);
    return flat.corners.empty() ? Widened{}
                                : measure_mesh_gaps(flat.mesh(), clearance[c], flat.uvs);
  });
  if (context.cancelled()) return Status::cancelled();
  return report;
}

Result<GapReport> widen_gaps(const MeshView& mesh, const GapLimits& limits, ChartSet& charts,
                             const Context& context) {
  if (Status s = check(mesh, limits.clearance, charts); !s.ok()) return s;
  if (!(limits.max_stretch > 1))
    return Status(ErrorCode::bad_option,
                  fmt::format("gaps: max_stretch is {} (above 1)", limits.max_stretch));
  const GapReport report = look_at_all(charts, limits.clearance, context, [&](std::size_t c) {
    Chart& chart = charts.charts[c];
    if (chart.kept) return Widened{};
    const double root = std::sqrt(chart.distortion.surface_area);
    const WidenOptions options{limits.clearance[c], limits.max_stretch, kMinAltitude * root};
    return widen(mesh, options, charts, chart);
  });
  if (report.charts > 0) charts.distortion = total_distortion(charts.charts);
  if (context.cancelled()) return Status::cancelled();
  return report;
}

}  // namespace atlas
