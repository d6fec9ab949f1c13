#include "libatlas/charts/cells/cells.h"

#include <algorithm>
#include <utility>

#include "libatlas/charts/cells/cell_distance.h"
#include "libatlas/charts/cells/grains.h"
#include "libatlas/charts/cells/rims.h"
#include "libatlas/charts/cells/ring_queue.h"
#include "libatlas/charts/cells/seeds.h"
#include "libatlas/core/glm_bridge.h"

namespace atlas {
namespace {

// Steps between needles. A step between two triangles in (nearly) one plane leads through needles
// if its square exceeds kNeedle times their area. It then counts as the sum of the two triangles'
// heights over their common edge, but as at least kLeastNeedleStep of the distance between their
// centroids. Without this, needles of CAD caps and of zigzag-triangulated walls are far apart even
// side by side, and cells grew across creases instead: a part of 15 000 triangles came out in 259
// charts, and in 6 with this rule. Needles around a tube are excluded by kFlatCosine, since their
// cells would become strips. Without the lower limit, strips a million times longer than wide are
// torn apart.
constexpr float kNeedle = 2, kFlatCosine = 0.999f, kLeastNeedleStep = 1.f / 40;

// One per piece.
std::vector<CellRuler> triangle_rulers(const Topology& topology) {
  std::vector<double> area(topology.component_count, 0);
  std::vector<std::size_t> count(topology.component_count, 0);
  for (std::uint32_t t = 0; t < topology.triangle_count(); ++t) {
    const std::uint32_t k = topology.component[t];
    if (k == kNoIndex) continue;
    area[k] += topology.areas[t];
    ++count[k];
  }
  std::vector<CellRuler> rulers;
  for (std::size_t k = 0; k < area.size(); ++k) rulers.emplace_back(area[k], count[k]);
  return rulers;
}

// The data that the last pass needs for a triangle, side by side in memory.
struct Ground {
  glm::vec3 middle, normal;
  float distance = kFar;  // negative once its cell is final
  std::uint32_t cell = kNoIndex;
};

struct Arrival {
  std::uint32_t key;  // of the distance
  std::uint32_t node;
};

std::vector<Ground> lay_ground(const Topology& topology) {
  std::vector<Ground> ground(topology.triangle_count());
  for (std::uint32_t t = 0; t < ground.size(); ++t) {
    ground[t].middle = centroid(topology, t);
    ground[t].normal = to_glm(topology.calm_normal(t));
  }
  return ground;
}

// Prefetches the data of the next visits. Fronts are long, so most of what a visit reads has left
// the caches; prefetching saves a quarter of all growing time on a million triangles. Inlining is
// forced because compilers drop calls to functions that do nothing but prefetch.
[[gnu::always_inline]] inline void fetch_ahead(const Topology& topology,
                                               const std::vector<Ground>& ground,
                                               const RingQueue<Arrival>& queue) {
  if (const Arrival* far = queue.ahead(12)) {
    __builtin_prefetch(&topology.opposite[3 * std::size_t{far->node}]);
    __builtin_prefetch(&ground[far->node]);
  }
  if (const Arrival* near = queue.ahead(6)) {
    for (std::uint32_t h = 3 * near->node; h < 3 * near->node + 3; ++h) {
      const std::uint32_t o = topology.opposite[h];
      if (o != kNoIndex) __builtin_prefetch(&ground[o / 3], 1);
    }
  }
}

// Returns the length of the step between centroids across half-edge h, shortened where it leads
// through needles.
float through_needles(const Topology& topology, std::uint32_t h, float step) {
  const float areas = topology.areas[h / 3] + topology.areas[topology.opposite[h] / 3];
  if (step * step <= kNeedle * areas) return step;
  const auto shared = static_cast<float>(edge_length(topology, h));
  return std::clamp(2 * areas / shared, kLeastNeedleStep * step, step);
}

// The last pass: assigns each triangle to a seed.
Cells grow_triangles(const CellInput& input, const Grains& grains, const CellSeeds& seeds,
                     const Context& context) {
  const Topology& topology = input.topology;
  constexpr std::uint32_t visits_between_looks = 4096;
  const std::size_t n = topology.triangle_count(), cells = seeds.grain.size();
  std::vector<std::uint32_t> seed(cells, kNoIndex);
  const std::vector<CellRuler> rulers = triangle_rulers(topology);
  std::vector<float> best(cells, kFar);
  std::vector<Ground> ground = lay_ground(topology);
  for (std::uint32_t t = 0; t < n; ++t) {
    const std::uint32_t g = grains.of_triangle[t];
    if (g == kNoIndex || seeds.grain[seeds.owner[g]] != g) continue;
    const CellRuler& ruler = rulers[topology.component[t]];
    const float d = glm::distance(ground[t].middle, grains.centroid[g]);
    const std::uint32_t s = seeds.owner[g];
    if (ruler.shorter(d, best[s])) {
      best[s] = d;
      seed[s] = t;
    }
  }
  RingQueue<Arrival> queue;
  std::uint32_t visits = 0;
  const auto piece = [&](std::uint32_t s) { return grains.component[seeds.grain[s]]; };
  for (std::uint32_t next = 0; next < cells || !queue.empty();) {
    // One piece after the other: its seeds are contiguous, and the queue stays small.
    if (queue.empty()) {
      const std::uint32_t first = next;
      queue.restart();
      for (; next < cells && piece(next) == piece(first); ++next) {
        // Where grains coincide, a cell may have no seed triangle, or the same one as another.
        if (seed[next] == kNoIndex || ground[seed[next]].cell != kNoIndex) continue;
        ground[seed[next]].distance = 0;
        ground[seed[next]].cell = next;
        queue.push({0, seed[next]});
      }
      continue;
    }
    if (++visits % visits_between_looks == 0 && context.cancelled()) return {};
    const Arrival visit = queue.pop();
    fetch_ahead(topology, ground, queue);
    Ground& here = ground[visit.node];
    if (here.distance < 0) continue;
    const float so_far = std::exchange(here.distance, -1.0f);
    const std::uint32_t own = here.cell;
    const glm::vec3 from = here.middle, axis = seeds.normal[own];
    const CellRuler& ruler = rulers[topology.component[visit.node]];
    for (std::uint32_t h = 3 * visit.node; h < 3 * visit.node + 3; ++h) {
      const std::uint32_t o = topology.opposite[h];
      if (o == kNoIndex || input.walled(visit.node, o / 3)) continue;
      Ground& next_to = ground[o / 3];
      if (next_to.distance < 0) continue;
      float step = glm::distance(from, next_to.middle);
      if (glm::dot(here.normal, next_to.normal) > kFlatCosine) {
        step = through_needles(topology, h, step);
      }
      const float distance = so_far + cell_distance(step, next_to.normal, axis);
      if (!ruler.take(distance, own, next_to.distance, next_to.cell)) continue;
      queue.push({std::max(ruler.key(distance), visit.key), o / 3});
    }
  }
  Cells result;
  result.count = static_cast<std::uint32_t>(cells);
  result.of_triangle.reserve(n);
  for (const Ground& g : ground) result.of_triangle.push_back(g.cell);
  pull_teeth(topology, input.regions, result);
  return result;
}

}  // namespace

Cells grow_cells(const CellInput& input, const CellOptions& options, const Context& context) {
  if (input.topology.component_count == 0) {
    return {std::vector<std::uint32_t>(input.topology.triangle_count(), kNoIndex), 0};
  }
  const Grains grains = grow_grains(input);
  const CellSeeds seeds = choose_seeds(input, grains, options, context);
  if (context.cancelled()) return {};
  return grow_triangles(input, grains, seeds, context);
}

}  // namespace atlas
