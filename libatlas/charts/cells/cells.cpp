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

// The last pass: assigns each triangle to the seed of a cell.
class TriangleGrowth {
  struct Settled {
    std::uint32_t triangle;
    float distance;
  };

 public:
  TriangleGrowth(const CellInput& input, const Grains& grains, const CellSeeds& seeds)
      : input_(input),
        topology_(input.topology),
        grains_(grains),
        seeds_(seeds),
        rulers_(triangle_rulers(topology_)),
        ground_(lay_ground(topology_)),
        seed_triangle_(seed_triangles()) {}

  // Returns nothing once cancelled.
  Cells run(const Context& context) {
    constexpr std::uint32_t visits_between_looks = 4096;
    std::uint32_t visits = 0;
    while (begin_piece()) {
      while (!queue_.empty()) {
        if (++visits % visits_between_looks == 0 && context.cancelled()) return {};
        const Arrival visit = queue_.pop();
        fetch_ahead(topology_, ground_, queue_);
        if (ground_[visit.node].distance >= 0) settle(visit);
      }
    }
    return cells();
  }

 private:
  // Returns for each cell the triangle of its seed's grain that is nearest to the grain's centroid.
  // Where grains coincide, a cell may have none, or the same one as another.
  std::vector<std::uint32_t> seed_triangles() const {
    std::vector<std::uint32_t> seed(seeds_.grain.size(), kNoIndex);
    std::vector<float> best(seed.size(), kFar);
    for (std::uint32_t t = 0; t < ground_.size(); ++t) {
      const std::uint32_t g = grains_.of_triangle[t];
      if (g == kNoIndex || seeds_.grain[seeds_.owner[g]] != g) continue;
      const float d = glm::distance(ground_[t].middle, grains_.centroid[g]);
      const std::uint32_t s = seeds_.owner[g];
      if (rulers_[topology_.component[t]].shorter(d, best[s])) {
        best[s] = d;
        seed[s] = t;
      }
    }
    return seed;
  }

  // Fills the queue with the seeds of the next piece that has any. They are contiguous, and with
  // one piece after the other the queue stays small. Returns false after the last piece.
  bool begin_piece() {
    const auto piece = [&](std::uint32_t s) { return grains_.component[seeds_.grain[s]]; };
    while (queue_.empty() && next_ < seed_triangle_.size()) {
      const std::uint32_t first = next_;
      queue_.restart();
      for (; next_ < seed_triangle_.size() && piece(next_) == piece(first); ++next_) {
        const std::uint32_t t = seed_triangle_[next_];
        if (t == kNoIndex || ground_[t].cell != kNoIndex) continue;
        ground_[t].distance = 0;
        ground_[t].cell = next_;
        queue_.push({0, t});
      }
    }
    return !queue_.empty();
  }

  // Makes the cell of a triangle final. The other triangles of its polygon join that cell, too.
  void settle(const Arrival& visit) {
    const std::uint32_t own = ground_[visit.node].cell;
    settled_.assign(1, {visit.node, std::exchange(ground_[visit.node].distance, -1.0f)});
    for (std::size_t i = 0; i < settled_.size(); ++i) {
      const Settled here = settled_[i];
      for (std::uint32_t h = 3 * here.triangle; h < 3 * here.triangle + 3; ++h) {
        if (!topology_.inner(h)) continue;
        Ground& mate = ground_[topology_.opposite[h] / 3];
        if (mate.distance < 0) continue;
        mate.distance = -1;
        mate.cell = own;
        settled_.push_back(
            {topology_.opposite[h] / 3,
             here.distance + glm::distance(ground_[here.triangle].middle, mate.middle)});
      }
    }
    for (const Settled& here : settled_) spread(here, visit.key);
  }

  // Offers the neighbours of a triangle whose cell is final to that cell.
  void spread(const Settled& settled, std::uint32_t key) {
    const Ground& here = ground_[settled.triangle];
    const float so_far = settled.distance;
    const std::uint32_t own = here.cell;
    const glm::vec3 from = here.middle, axis = seeds_.normal[own];
    const CellRuler& ruler = rulers_[topology_.component[settled.triangle]];
    for (std::uint32_t h = 3 * settled.triangle; h < 3 * settled.triangle + 3; ++h) {
      const std::uint32_t o = topology_.opposite[h];
      if (o == kNoIndex || input_.walled(settled.triangle, o / 3)) continue;
      Ground& next_to = ground_[o / 3];
      if (next_to.distance < 0) continue;
      float step = glm::distance(from, next_to.middle);
      if (glm::dot(here.normal, next_to.normal) > kFlatCosine)
        step = through_needles(topology_, h, step);
      const float distance = so_far + cell_distance(step, next_to.normal, axis);
      if (!ruler.take(distance, own, next_to.distance, next_to.cell)) continue;
      queue_.push({std::max(ruler.key(distance), key), o / 3});
    }
  }

  Cells cells() const {
    Cells result;
    result.count = static_cast<std::uint32_t>(seed_triangle_.size());
    result.of_triangle.reserve(ground_.size());
    for (const Ground& g : ground_) result.of_triangle.push_back(g.cell);
    pull_teeth(topology_, input_.regions, result);
    return result;
  }

  const CellInput& input_;
  const Topology& topology_;
  const Grains& grains_;
  const CellSeeds& seeds_;
  const std::vector<CellRuler> rulers_;       // one per piece
  std::vector<Ground> ground_;                // one per triangle
  std::vector<std::uint32_t> seed_triangle_;  // one per cell, or kNoIndex
  RingQueue<Arrival> queue_;
  std::vector<Settled> settled_;  // scratch memory
  std::uint32_t next_ = 0;        // the first cell of the pieces to come
};

// Removes the numbers of cells without triangles.
void renumber(Cells& cells) {
  std::vector<std::uint32_t> number(cells.count, kNoIndex);
  for (const std::uint32_t k : cells.of_triangle) {
    if (k != kNoIndex) number[k] = 0;
  }
  std::uint32_t count = 0;
  for (std::uint32_t& k : number) {
    if (k != kNoIndex) k = count++;
  }
  for (std::uint32_t& k : cells.of_triangle) {
    if (k != kNoIndex) k = number[k];
  }
  cells.count = count;
}

// Gives cells without area to their neighbours, across the longest edges: nothing can be fitted to
// them, so they would part what their triangles join. Those beside cells with area go first, then
// those beside them, and so on.
void dissolve_thin_cells(const Topology& topology, Cells& cells) {
  std::vector<std::uint8_t> has_area(cells.count, 0);
  std::vector<std::uint32_t> wave;
  for (std::uint32_t t = 0; t < topology.triangle_count(); ++t) {
    if (cells.of_triangle[t] == kNoIndex) continue;
    if (topology.thin(t)) {
      wave.push_back(t);
    } else {
      has_area[cells.of_triangle[t]] = 1;
    }
  }
  const auto lost = [&](std::uint32_t t) { return !has_area[cells.of_triangle[t]]; };
  const auto neighbour_with_area = [&](std::uint32_t t) {
    double longest = -1;
    std::uint32_t to = kNoIndex;
    for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
      const std::uint32_t o = topology.opposite[h];
      if (o == kNoIndex || lost(o / 3) || edge_length(topology, h) <= longest) continue;
      longest = edge_length(topology, h);
      to = cells.of_triangle[o / 3];
    }
    return to;
  };
  std::erase_if(wave, [&](std::uint32_t t) { return !lost(t); });
  if (wave.empty()) return;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> joins;  // triangles, and their cells
  while (!wave.empty()) {
    joins.clear();
    for (const std::uint32_t t : wave) {
      const std::uint32_t to = lost(t) ? neighbour_with_area(t) : kNoIndex;
      if (to != kNoIndex) joins.emplace_back(t, to);
    }
    wave.clear();
    for (const auto& [t, to] : joins) {
      if (!lost(t)) continue;
      cells.of_triangle[t] = to;
      for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
        const std::uint32_t o = topology.opposite[h];
        if (o != kNoIndex && lost(o / 3)) wave.push_back(o / 3);
      }
    }
  }
  renumber(cells);
}

}  // namespace

Cells grow_cells(const CellInput& input, const CellOptions& options, const Context& context) {
  if (input.topology.component_count == 0) {
    return {std::vector<std::uint32_t>(input.topology.triangle_count(), kNoIndex), 0};
  }
  const Grains grains = grow_grains(input);
  const CellSeeds seeds = choose_seeds(input, grains, options, context);
  if (context.cancelled()) return {};
  Cells cells = TriangleGrowth(input, grains, seeds).run(context);
  if (!context.cancelled()) dissolve_thin_cells(input.topology, cells);
  if (!input.topology.polygon.empty()) renumber(cells);  // a polygon may have held two seeds
  return cells;
}

}  // namespace atlas
