#include "libatlas/charts/mesh/local_chart.h"

#include <algorithm>

#include "libatlas/core/glm_bridge.h"

namespace atlas {
namespace {

// The solver of a chart of this size no longer fits the caches.
constexpr std::uint32_t kTooManyForCaches = 30000;
// Data is prefetched this many triangles ahead; waiting for memory would otherwise take most of the
// time.
constexpr std::uint32_t kAhead = 16;

}  // namespace

void LocalChart::build(const Topology& topology, Partition& partition,
                       std::span<const std::uint32_t> triangles) {
  triangles_ = triangles;
  const auto n = static_cast<std::uint32_t>(triangles.size());
  for (std::uint32_t i = 0; i < n; ++i) partition.local[triangles[i]] = i;
  link(topology, partition);
  find_components();
  number_vertices(topology);
  find_loops();
  if (n >= kTooManyForCaches) {  // frees memory for the solver
    std::vector<std::uint32_t>().swap(queue_);
    std::vector<std::uint8_t>().swap(seen_);
    if (component_count == 1) std::vector<std::uint32_t>().swap(component);
  }
}

// A chart that is the whole mesh and has no seams uses the mesh's links without copying them, since
// such a chart needs the most memory of all.
void LocalChart::link(const Topology& topology, const Partition& partition) {
  const auto n = static_cast<std::uint32_t>(triangles_.size());
  const auto cut = [](std::uint8_t seams) { return seams != 0; };
  if (n == topology.triangle_count() &&
      std::none_of(partition.seams.begin(), partition.seams.end(), cut)) {
    opposite = topology.opposite;
    return;
  }
  const std::uint32_t chart = partition.chart[triangles_[0]];
  linked_.assign(3 * std::size_t{n}, kNoIndex);
  for (std::uint32_t i = 0; i < n; ++i) {
    for (std::uint32_t c = 0; c < 3; ++c) {
      const std::uint32_t h = 3 * triangles_[i] + c, o = topology.opposite[h];
      if (o == kNoIndex || partition.chart[o / 3] != chart || partition.seam(h)) continue;
      linked_[3 * i + c] = 3 * partition.local[o / 3] + o % 3;
    }
  }
  opposite = linked_;
}

// A local vertex is a fan of corners joined by edges of the chart, so a vertex where only corners
// touch is duplicated. In large charts neighbours get numbers close to each other, so that solvers
// work within the processor's caches, whatever the order of the mesh.
void LocalChart::number_vertices(const Topology& topology) {
  const auto n = static_cast<std::uint32_t>(triangles_.size());
  corners.assign(n, {kNoIndex, kNoIndex, kNoIndex});
  positions.clear();
  vertex.clear();
  density.clear();
  const auto corner = [&](std::uint32_t h) -> std::uint32_t& { return corners[h / 3][h % 3]; };
  for (std::uint32_t i = 0; i < 3 * n; ++i) {
    const std::uint32_t start = n < kTooManyForCaches ? i : 3 * queue_[i / 3] + i % 3;
    if (n >= kTooManyForCaches && i / 3 + kAhead < n) {
      const std::uint32_t later = queue_[i / 3 + kAhead];
      __builtin_prefetch(corners.data() + later, 1);
      __builtin_prefetch(opposite.data() + 3 * std::size_t{later});
      __builtin_prefetch(topology.corner_vertex.data() + 3 * std::size_t{triangles_[later]});
    }
    if (corner(start) != kNoIndex) continue;
    const auto id = static_cast<std::uint32_t>(positions.size());
    const std::uint32_t v =
        topology.corner_vertex[3 * std::size_t{triangles_[start / 3]} + start % 3];
    vertex.push_back(v);
    positions.push_back(topology.points[v]);
    corner(start) = id;
    std::uint32_t h = start;
    for (;;) {
      const std::uint32_t o = opposite[previous_half_edge(h)];
      if (o == kNoIndex || o == start) break;
      h = o;
      corner(h) = id;
    }
    if (opposite[previous_half_edge(h)] != kNoIndex) continue;  // all the way round
    for (std::uint32_t o = opposite[start]; o != kNoIndex; o = opposite[h]) {
      h = next_half_edge(o);
      corner(h) = id;
    }
  }
}

void LocalChart::find_loops() {
  loops.clear();
  border_count = 0;
  seen_.assign(opposite.size(), 0);
  for (std::uint32_t h = 0; h < opposite.size(); ++h) {
    if (opposite[h] != kNoIndex || seen_[h]) continue;
    loops.push_back(h);
    for (std::uint32_t g = h; !seen_[g]; g = next_border(g)) {
      seen_[g] = 1;
      ++border_count;
    }
  }
}

void LocalChart::find_components() {
  const auto n = static_cast<std::uint32_t>(triangles_.size());
  component.assign(n, kNoIndex);
  component_count = 0;
  queue_.clear();
  for (std::uint32_t seed = 0; seed < n; ++seed) {
    if (component[seed] != kNoIndex) continue;
    component[seed] = component_count;
    std::size_t next = queue_.size();
    queue_.push_back(seed);
    while (next < queue_.size()) {
      const std::uint32_t t = queue_[next++];
      for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
        if (opposite[h] == kNoIndex || component[opposite[h] / 3] != kNoIndex) continue;
        component[opposite[h] / 3] = component_count;
        queue_.push_back(opposite[h] / 3);
        __builtin_prefetch(opposite.data() + opposite[h]);
      }
    }
    ++component_count;
  }
}

void LocalChart::take_density(std::span<const float> all) {
  density.clear();
  if (all.empty()) return;
  for (const std::uint32_t t : triangles_) density.push_back(all[t]);
}

double LocalChart::surface_area(const Topology& topology) const {
  double area = 0;
  for (const std::uint32_t t : triangles_) area += topology.areas[t];
  return area;
}

double LocalChart::target_area(const Topology& topology) const {
  if (density.empty()) return surface_area(topology);
  double area = 0;
  for (std::size_t i = 0; i < triangles_.size(); ++i) {
    area += topology.areas[triangles_[i]] * density[i] * density[i];
  }
  return area;
}

}  // namespace atlas
