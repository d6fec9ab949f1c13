#include "libatlas/uvs/written_stretch.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "libatlas/charts/chart_triangles.h"
#include "libatlas/core/parallel.h"

namespace atlas {
namespace {

class Meter {
 public:
  Meter(const MeshView& mesh, const PlacedCharts& placed, std::span<const Vec2f> uvs)
      : mesh_(mesh), placed_(placed), uvs_(uvs) {}

  double stretch_999(const ChartPlacement& placement) {
    const ChartSet& set = placed_.charts;
    const Chart& chart = set.charts[placement.chart];
    const Extent page = placed_.pages[std::size_t(placement.page)];
    positions_.clear();
    at_.clear();
    triangles_.clear();
    density_.clear();
    for (std::uint32_t i = chart.first_uv; i < chart.first_uv + chart.uv_count; ++i) {
      positions_.push_back(mesh_.positions[set.uv_vertex[i]]);
      at_.push_back(
          chart_uv(placement, {double(uvs_[i].x) * page.width, double(uvs_[i].y) * page.height}));
    }
    for (const std::uint32_t t : triangles_of(set, chart)) {
      const std::uint32_t* c = &set.triangle_uv[3 * std::size_t{t}];
      triangles_.push_back({c[0] - chart.first_uv, c[1] - chart.first_uv, c[2] - chart.first_uv});
      if (!mesh_.density.empty()) density_.push_back(mesh_.density[t]);
    }
    const PositionView positions(positions_, positions_.front());
    return measure_distortion({positions, triangles_, density_}, at_).stretch_999;
  }

 private:
  const MeshView& mesh_;
  const PlacedCharts& placed_;
  std::span<const Vec2f> uvs_;
  std::vector<Vec3f> positions_;
  std::vector<Vec2d> at_;
  std::vector<std::array<std::uint32_t, 3>> triangles_;
  std::vector<double> density_;
};

}  // namespace

WrittenStretch measure_written(const MeshView& mesh, const PlacedCharts& placed,
                               std::span<const Vec2f> uvs, double max_stretch,
                               const Context& context) {
  std::vector<double> stretch(placed.placements.size(), 1);
  parallel_for(context, stretch.size(), 16, [&](std::size_t begin, std::size_t end) {
    Meter meter(mesh, placed, uvs);
    for (std::size_t i = begin; i < end; ++i) stretch[i] = meter.stretch_999(placed.placements[i]);
  });
  const double limit = max_stretch + 0.01 * (max_stretch - 1) + 1e-4;
  WrittenStretch written;
  for (std::size_t i = 0; i < stretch.size(); ++i) {
    const Chart& chart = placed.charts.charts[placed.placements[i].chart];
    written.stretch_999 = std::max(written.stretch_999, stretch[i]);
    written.beyond +=
        !chart.kept && chart.distortion.stretch_999 <= max_stretch && stretch[i] > limit;
  }
  return written;
}

}  // namespace atlas
