#include "libatlas/charts/merge.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <queue>

#include "libatlas/charts/cells.h"
#include "libatlas/core/glm_bridge.h"

namespace atlas {

Segmentation segment(const Topology& topology, const ChartOptions& options,
                     const Context& context) {
  Cells cells = grow_cells(topology, CellOptions{}, context);
  Segmentation result;
  const std::size_t n = topology.triangle_count();
  std::vector<glm::dvec3> normal(cells.count, glm::dvec3(0));
  for (std::uint32_t t = 0; t < n; ++t) {
    if (cells.of_triangle[t] == kNoIndex) continue;
    normal[cells.of_triangle[t]] += double(topology.areas[t]) * to_dvec(topology.normals[t]);
  }
  std::vector<std::uint32_t> parent(cells.count);
  std::iota(parent.begin(), parent.end(), 0u);
  const auto find = [&](std::uint32_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  std::vector<std::vector<std::uint32_t>> members(cells.count);
  for (std::uint32_t i = 0; i < cells.count; ++i) members[i] = {i};
  std::map<std::pair<std::uint32_t, std::uint32_t>, double> shared;
  for (std::uint32_t h = 0; h < topology.opposite.size(); ++h) {
    const std::uint32_t o = topology.opposite[h];
    if (o == kNoIndex || o < h) continue;
    const std::uint32_t a = cells.of_triangle[h / 3], b = cells.of_triangle[o / 3];
    if (a != b) shared[{std::min(a, b), std::max(a, b)}] += 1;
  }
  using Entry = std::pair<double, std::pair<std::uint32_t, std::uint32_t>>;
  std::vector<Entry> pairs;
  const double limit = options.cone_degrees > 0 ? std::cos(0.8 * options.cone_degrees * M_PI / 180)
                                                : std::cos(30 * M_PI / 180);
  const auto unit = [](const glm::dvec3& v) { return v / std::max(1e-300, glm::length(v)); };
  for (const auto& [pair, length] : shared) {
    pairs.push_back({-glm::dot(unit(normal[pair.first]), unit(normal[pair.second])), pair});
  }
  std::sort(pairs.begin(), pairs.end());
  for (const auto& [cost, pair] : pairs) {
    const std::uint32_t a = find(pair.first), b = find(pair.second);
    if (a == b) continue;
    const glm::dvec3 axis = unit(normal[a] + normal[b]);
    bool fits = true;
    for (const std::uint32_t root : {a, b}) {
      for (const std::uint32_t m : members[root]) {
        fits = fits && glm::dot(unit(normal[m]), axis) > limit;
      }
    }
    if (!fits) continue;
    parent[b] = a;
    normal[a] += normal[b];
    members[a].insert(members[a].end(), members[b].begin(), members[b].end());
  }
  result.partition.chart = std::move(cells.of_triangle);
  for (std::uint32_t& c : result.partition.chart) {
    if (c != kNoIndex) c = find(c);
  }
  return result;
}

}  // namespace atlas
