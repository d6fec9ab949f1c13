#include "libatlas/charts/flattening/slits.h"

#include <algorithm>
#include <cmath>

#include "libatlas/core/disjoint_sets.h"
#include "libatlas/core/glm_bridge.h"
#include "libatlas/param/injectivity.h"

namespace atlas {
namespace {

constexpr double kTolerance = 1e-6;  // relative to an edge's length

class SlitCloser {
 public:
  explicit SlitCloser(const Topology& topology)
      : topology_(topology), first_uv_(topology.points.size(), kNoIndex) {}

  bool close(FlatChart& chart) {
    if (!touches_itself(chart)) return false;
    if (local_.empty()) local_.assign(topology_.triangle_count(), kNoIndex);
    for (std::uint32_t i = 0; i < chart.triangles.size(); ++i) local_[chart.triangles[i]] = i;
    weld(chart);
    for (const std::uint32_t t : chart.triangles) local_[t] = kNoIndex;
    return apply(chart);
  }

 private:
  // Whether two uvs of one vertex lie close to each other, relative to the chart's size.
  bool touches_itself(const FlatChart& chart) {
    const double near = kTolerance * (chart.size.x + chart.size.y);
    bool found = false;
    for (std::uint32_t i = 0; i < chart.uvs.size(); ++i) {
      std::uint32_t& first = first_uv_[chart.vertex[i]];
      if (first == kNoIndex) {
        first = i;
      } else {
        found |= glm::distance(to_glm(chart.uvs[first]), to_glm(chart.uvs[i])) <= near;
      }
    }
    for (const std::uint32_t v : chart.vertex) first_uv_[v] = kNoIndex;
    return found;
  }

  // Fills same_as_, the sets of uvs that become one.
  void weld(const FlatChart& chart) {
    same_as_ = DisjointSets(chart.uvs.size());
    for (std::uint32_t i = 0; i < chart.triangles.size(); ++i) {
      for (std::uint32_t c = 0; c < 3; ++c) {
        const std::uint32_t h = 3 * chart.triangles[i] + c, o = topology_.opposite[h];
        if (o == kNoIndex || o < h || local_[o / 3] == kNoIndex) continue;
        const std::array<std::uint32_t, 3>& there = chart.corners[local_[o / 3]];
        const std::uint32_t a = chart.corners[i][c], b = chart.corners[i][(c + 1) % 3];
        const std::uint32_t a2 = there[(o + 1) % 3], b2 = there[o % 3];
        if (a == a2 && b == b2) continue;
        const auto gap = [&](std::uint32_t p, std::uint32_t q) {
          return glm::distance(to_glm(chart.uvs[p]), to_glm(chart.uvs[q]));
        };
        if (std::max(gap(a, a2), gap(b, b2)) > kTolerance * gap(a, b)) continue;
        same_as_.join(a, a2);
        same_as_.join(b, b2);
      }
    }
  }

  bool apply(FlatChart& chart) {
    std::vector<std::uint32_t> renamed(chart.uvs.size());
    std::vector<std::uint32_t> vertex;
    std::vector<Vec2d> uvs;
    for (std::uint32_t i = 0; i < renamed.size(); ++i) {
      const std::uint32_t r = same_as_.find(i);
      if (r == i) {
        renamed[i] = static_cast<std::uint32_t>(uvs.size());
        uvs.push_back(chart.uvs[i]);
        vertex.push_back(chart.vertex[i]);
      } else {
        renamed[i] = renamed[r];  // r < i
      }
    }
    if (uvs.size() == renamed.size()) return false;
    std::vector<std::array<std::uint32_t, 3>> corners = chart.corners;
    for (auto& triangle : corners) {
      for (std::uint32_t& corner : triangle) corner = renamed[corner];
    }
    std::vector<Vec3d> positions;
    for (const std::uint32_t v : vertex)
      positions.push_back(from_glm(to_dvec(topology_.points[v])));
    if (!check_injectivity({positions, corners}, uvs).injective) return false;
    chart.corners = std::move(corners);
    chart.vertex = std::move(vertex);
    chart.uvs = std::move(uvs);
    return true;
  }

  const Topology& topology_;
  std::vector<std::uint32_t> first_uv_;  // one per vertex; kNoIndex between charts
  std::vector<std::uint32_t> local_;     // one per triangle, likewise
  DisjointSets same_as_{0};
};

}  // namespace

std::size_t close_slits(const Topology& topology, std::vector<FlatChart>& charts,
                        const Context& context) {
  SlitCloser closer(topology);
  std::size_t closed = 0;
  for (FlatChart& chart : charts) {
    if (context.cancelled()) break;
    if (!chart.kept) closed += closer.close(chart);
  }
  return closed;
}

}  // namespace atlas
