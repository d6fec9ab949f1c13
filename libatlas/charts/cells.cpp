#include "libatlas/charts/cells.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "libatlas/charts/grains.h"
#include "libatlas/charts/rims.h"
#include "libatlas/charts/ring_queue.h"
#include "libatlas/core/glm_bridge.h"

namespace atlas {
namespace {

constexpr float kNormalWeight = 8;  // of the lean in the distance, as published figures were found
constexpr std::size_t kCellsOfSmallMesh = 146;
constexpr double kFlatSpread = 1e-6;
constexpr std::uint32_t kCalmGrain = 3;
constexpr std::uint32_t kLeastPerCell = 3;
constexpr float kFar = std::numeric_limits<float>::infinity();
// Distances that differ by less than this share of a mean step tie: symmetric meshes are full of
// ties, which rounding would break otherwise for every rotation and unit. (Whole parts of a step,
// compared instead, differ where what ties lies at the limit of one.)
constexpr double kTie = 0.0041;
constexpr double kKeysPerStep = 66, kLargestKey = 2e9;
constexpr float kBetweenParts = 0.29f;  // so that round values are not at a part's limit
constexpr float kCosineParts = 4096;
constexpr std::uint32_t kStretch = 64;  // grains

// What distances in a piece are measured by: its mean step.
class Ruler {
 public:
  Ruler() = default;
  Ruler(double area, std::size_t steps) {
    const double step = steps > 0 ? std::sqrt(area / double(steps)) : 0;
    if (!(step > 0)) return;
    keys_ = kKeysPerStep / step;
    tie_ = static_cast<float>(kTie * step);
  }
  std::uint32_t key(float distance) const {
    return static_cast<std::uint32_t>(std::min(keys_ * distance, kLargestKey));
  }
  bool shorter(float a, float b) const { return a < b - tie_; }

  // What is nearest so far, and to which seed. Of seeds that tie the lowest counts. Returns whether
  // the other one is nearer.
  bool take(float distance, std::uint32_t seed, float& nearest, std::uint32_t& owner) const {
    if (distance > nearest + tie_ || (seed == owner && !(distance < nearest))) return false;
    if (distance >= nearest - tie_ && seed > owner) return false;
    nearest = std::min(nearest, distance);
    owner = seed;
    return true;
  }

 private:
  double keys_ = 0;
  float tie_ = 0;
};

struct Visit {
  std::uint32_t key;  // of the distance
  float distance;
  std::uint32_t node, seed;
};

// Chooses seeds among the grains.
class Seeder {
 public:
  Seeder(const Topology& topology, const Grains& grains, const CellOptions& options,
         const Context& context)
      : topology_(topology), grains_(grains), options_(options), context_(context) {}

  // One grain a cell, with the mean normal of what it is to stand for.
  void run() {
    distance_.assign(grains_.count(), kFar);
    owner_.assign(grains_.count(), kNoIndex);
    std::vector<std::uint32_t> size(topology_.component_count, 0);
    for (const std::uint32_t k : topology_.component) size[k == kNoIndex ? 0 : k] += k != kNoIndex;
    for (std::uint32_t first = 0, last = 0; first < grains_.count() && !context_.cancelled();
         first = last) {
      while (last < grains_.count() && grains_.component[last] == grains_.component[first]) ++last;
      const std::size_t first_seed = seeds.size();
      double area = 0;
      for (std::uint32_t g = first; g < last; ++g) area += grains_.area[g];
      ruler_ = Ruler(area, last - first);
      const std::uint32_t budget =
          flat(first, last) ? 1 : cell_budget(size[grains_.component[first]], options_);
      sample_piece(first, last, budget);
      if (seeds.size() == first_seed + 1) continue;
      number_by_grain(first, last, first_seed);
      for (int round = 0; round < 2; ++round) recentre(first, last, first_seed);
    }
  }

  std::vector<std::uint32_t> seeds;  // grains
  std::vector<glm::vec3> normals;    // 1 a seed
  const std::vector<std::uint32_t>& owner() const { return owner_; }

 private:
  // A piece that lies in one plane is one chart whatever its outline, so one cell will do.
  bool flat(std::uint32_t first, std::uint32_t last) const {
    glm::dvec3 sum(0);
    double area = 0;
    for (std::uint32_t g = first; g < last; ++g) {
      sum += double(grains_.area[g]) * glm::dvec3(grains_.normal[g]);
      area += grains_.area[g];
    }
    return area > 0 && glm::length(sum) > area * (1 - kFlatSpread);
  }

  void add_seed(std::uint32_t grain) {
    seeds.push_back(grain);
    normals.push_back(grains_.normal[grain]);
    queue_.restart();
    offer({0, 0, grain, static_cast<std::uint32_t>(seeds.size() - 1)});
    spread();
  }

  void offer(Visit visit) {
    float& nearest = distance_[visit.node];
    if (!ruler_.take(visit.distance, visit.seed, nearest, owner_[visit.node])) return;
    visit.distance = nearest;
    queue_.push(visit);
  }

  void spread() {
    while (!queue_.empty()) {
      const Visit visit = queue_.pop();
      if (visit.distance != distance_[visit.node] || visit.seed != owner_[visit.node]) continue;
      const glm::vec3 axis = normals[visit.seed];
      for (std::uint32_t i = grains_.first[visit.node]; i < grains_.first[visit.node + 1]; ++i) {
        const std::uint32_t next = grains_.neighbour[i];
        const float lean = 1 - glm::dot(grains_.normal[next], axis);
        const float distance = visit.distance + grains_.distance[i] * (1 + kNormalWeight * lean);
        offer({std::max(ruler_.key(distance), visit.key), distance, next, visit.seed});
      }
    }
  }

  void sample_piece(std::uint32_t first, std::uint32_t last, std::uint32_t budget) {
    farthest_.assign((last - first + kStretch - 1) / kStretch, kFar);
    add_seed(first + static_cast<std::uint32_t>(options_.first_seed * (last - first)));
    for (std::uint32_t count = 1; count < budget && !context_.cancelled(); ++count) {
      const std::uint32_t grain = farthest(first, last);
      if (distance_[grain] == 0) break;
      add_seed(grain);
    }
    add_leaning(first, last);
  }

  // The last of those that are farthest from all seeds. While seeds are added distances only fall,
  // so what is remembered of a stretch of grains bounds them, and few stretches are looked at
  // again.
  std::uint32_t farthest(std::uint32_t first, std::uint32_t last) {
    const auto end_of = [&](std::size_t s) {
      return std::min<std::uint32_t>(last, first + kStretch * static_cast<std::uint32_t>(s + 1));
    };
    const auto look_again = [&](std::size_t s) {
      std::int32_t most = 0;  // bits order as what they stand for; compilers compare four at once
      for (std::uint32_t g = first + kStretch * std::uint32_t(s); g < end_of(s); ++g) {
        most = std::max(most, std::bit_cast<std::int32_t>(distance_[g]));
      }
      return std::exchange(farthest_[s], std::bit_cast<float>(most)) == std::bit_cast<float>(most);
    };
    std::size_t s = 0;
    do {
      s = std::size_t(std::max_element(farthest_.begin(), farthest_.end()) - farthest_.begin());
    } while (!look_again(s));
    const float most = farthest_[s];
    for (s = farthest_.size(); s-- > 0;) {
      if (ruler_.shorter(farthest_[s], most)) continue;
      for (std::uint32_t g = end_of(s); g-- > first + kStretch * std::uint32_t(s);) {
        if (!ruler_.shorter(distance_[g], most)) return g;
      }
      look_again(s);
    }
    return first;  // not reached: the farthest itself is no nearer
  }

  // Seeds that are about equally far from all others are found in an order that rounding decides.
  // It is forgotten here, for ties fall by a seed's number: the last grain's seed comes first.
  void number_by_grain(std::uint32_t first, std::uint32_t last, std::size_t first_seed) {
    const auto begin = static_cast<std::uint32_t>(first_seed);
    std::vector<std::uint32_t> order(seeds.size() - first_seed), number(order.size());
    std::iota(order.begin(), order.end(), begin);
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
      return std::pair(seeds[a], a) > std::pair(seeds[b], b);
    });
    const std::vector<std::uint32_t> old_seeds(seeds.begin() + begin, seeds.end());
    const std::vector<glm::vec3> old_normals(normals.begin() + begin, normals.end());
    for (std::uint32_t i = 0; i < order.size(); ++i) {
      number[order[i] - begin] = begin + i;
      seeds[begin + i] = old_seeds[order[i] - begin];
      normals[begin + i] = old_normals[order[i] - begin];
    }
    for (std::uint32_t g = first; g < last; ++g) owner_[g] = number[owner_[g] - begin];
  }

  // Seeds for what leans too far from its cell, a few at a time.
  void add_leaning(std::uint32_t first, std::uint32_t last) {
    const auto limit = static_cast<float>(std::cos(options_.max_lean_degrees * M_PI / 180));
    const auto cosine = [&](std::uint32_t g) {
      return glm::dot(calm_normal(g), normals[owner_[g]]);
    };
    for (int round = 0; round < 6; ++round) {
      std::vector<std::pair<int, std::uint32_t>> leaning;
      for (std::uint32_t g = first; g < last; ++g) {
        const float c = cosine(g);
        if (c < limit)
          leaning.push_back({static_cast<int>(std::floor(kCosineParts * c + kBetweenParts)), g});
      }
      if (leaning.empty()) return;
      std::sort(leaning.begin(), leaning.end());
      for (const auto& [worst, g] : leaning) {
        if (cosine(g) < limit) add_seed(g);
      }
    }
  }

  // A grain's normal; of several triangles, with its neighbours' in the cell, for a few triangles
  // may lean by noise alone.
  glm::vec3 calm_normal(std::uint32_t g) const {
    if (grains_.size[g] < kCalmGrain) return grains_.normal[g];
    glm::vec3 sum = grains_.area[g] * grains_.normal[g];
    for (std::uint32_t i = grains_.first[g]; i < grains_.first[g + 1]; ++i) {
      const std::uint32_t n = grains_.neighbour[i];
      if (owner_[n] != owner_[g]) continue;  // it may lie beyond a crease
      sum += grains_.area[n] * grains_.normal[n];
    }
    const float length = glm::length(sum);
    return length > 0 ? sum / length : grains_.normal[g];
  }

  void recentre(std::uint32_t first, std::uint32_t last, std::size_t first_seed) {
    struct Sum {
      glm::dvec3 middle{0}, normal{0};  // double: single would decide what nearly ties
      double area = 0;
      float best = kFar;
    };
    std::vector<Sum> sums(seeds.size() - first_seed);
    for (std::uint32_t g = first; g < last; ++g) {
      Sum& sum = sums[owner_[g] - first_seed];
      sum.middle += double(grains_.area[g]) * glm::dvec3(grains_.centroid[g]);
      sum.normal += double(grains_.area[g]) * glm::dvec3(grains_.normal[g]);
      sum.area += grains_.area[g];
    }
    for (std::uint32_t g = first; g < last; ++g) {
      Sum& sum = sums[owner_[g] - first_seed];
      const auto d =
          static_cast<float>(glm::distance(glm::dvec3(grains_.centroid[g]), sum.middle / sum.area));
      if (ruler_.shorter(d, sum.best)) {
        sum.best = d;
        seeds[owner_[g]] = g;
      }
      distance_[g] = kFar;
    }
    queue_.restart();
    for (std::size_t s = first_seed; s < seeds.size(); ++s) {
      const glm::dvec3& normal = sums[s - first_seed].normal;
      const double length = glm::length(normal);
      if (length > 0) normals[s] = normal / length;
      offer({0, 0, seeds[s], static_cast<std::uint32_t>(s)});
    }
    spread();
  }

  const Topology& topology_;
  const Grains& grains_;
  const CellOptions& options_;
  const Context& context_;
  std::vector<float> distance_;
  std::vector<std::uint32_t> owner_;
  std::vector<float> farthest_;  // 1 a stretch of the piece's grains: none is farther
  Ruler ruler_;                  // of the piece at hand
  RingQueue<Visit> queue_;
};

// One a piece.
std::vector<Ruler> triangle_rulers(const Topology& topology) {
  std::vector<double> area(topology.component_count, 0);
  std::vector<std::size_t> count(topology.component_count, 0);
  for (std::uint32_t t = 0; t < topology.triangle_count(); ++t) {
    const std::uint32_t k = topology.component[t];
    if (k == kNoIndex) continue;
    area[k] += topology.areas[t];
    ++count[k];
  }
  std::vector<Ruler> rulers;
  for (std::size_t k = 0; k < area.size(); ++k) rulers.emplace_back(area[k], count[k]);
  return rulers;
}

// What the last pass asks of a triangle, side by side in memory.
struct Ground {
  glm::vec3 middle, normal;
  float distance = kFar;  // negative once it has its cell
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

// Fronts are long, so most of what a visit reads has left the caches: it is asked for in time, a
// quarter off the whole of growing on a million triangles. Inlined by force: compilers drop calls
// of functions that do nothing but this.
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

// The last pass: triangles to seeds.
Cells grow_triangles(const Topology& topology, const Grains& grains, const Seeder& seeder,
                     const Context& context) {
  constexpr std::uint32_t visits_between_looks = 4096;
  const std::size_t n = topology.triangle_count(), cells = seeder.seeds.size();
  std::vector<std::uint32_t> seed(cells, kNoIndex);
  const std::vector<Ruler> rulers = triangle_rulers(topology);
  std::vector<float> best(cells, kFar);
  std::vector<Ground> ground = lay_ground(topology);
  for (std::uint32_t t = 0; t < n; ++t) {
    const std::uint32_t g = grains.of_triangle[t];
    if (g == kNoIndex || seeder.seeds[seeder.owner()[g]] != g) continue;
    const Ruler& ruler = rulers[topology.component[t]];
    const float d = glm::distance(ground[t].middle, grains.centroid[g]);
    const std::uint32_t s = seeder.owner()[g];
    if (ruler.shorter(d, best[s])) {
      best[s] = d;
      seed[s] = t;
    }
  }
  RingQueue<Arrival> queue;
  std::uint32_t visits = 0;
  const auto piece = [&](std::uint32_t s) { return grains.component[seeder.seeds[s]]; };
  for (std::uint32_t next = 0; next < cells || !queue.empty();) {
    if (queue.empty()) {  // pieces in turn: their seeds are contiguous, and the queue stays small
      const std::uint32_t first = next;
      queue.restart();
      for (; next < cells && piece(next) == piece(first); ++next) {
        // Coincident grains may have left a cell empty, or given one seed to two.
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
    const glm::vec3 from = here.middle, axis = seeder.normals[own];
    const Ruler& ruler = rulers[topology.component[visit.node]];
    for (std::uint32_t h = 3 * visit.node; h < 3 * visit.node + 3; ++h) {
      const std::uint32_t o = topology.opposite[h];
      if (o == kNoIndex) continue;
      Ground& next_to = ground[o / 3];
      if (next_to.distance < 0) continue;
      const float lean = 1 - glm::dot(next_to.normal, axis);
      const float step = glm::distance(from, next_to.middle);
      const float distance = so_far + step * (1 + kNormalWeight * lean);
      if (!ruler.take(distance, own, next_to.distance, next_to.cell)) continue;
      queue.push({std::max(ruler.key(distance), visit.key), o / 3});
    }
  }
  Cells result;
  result.count = static_cast<std::uint32_t>(cells);
  result.of_triangle.reserve(n);
  for (const Ground& g : ground) result.of_triangle.push_back(g.cell);
  pull_teeth(topology, result);
  return result;
}

}  // namespace

Cells grow_cells(const Topology& topology, const CellOptions& wanted, const Context& context) {
  const std::size_t triangles = std::max(wanted.mesh_triangles, topology.triangle_count());
  CellOptions options = wanted;
  options.triangles_per_cell =
      std::clamp(static_cast<std::uint32_t>(triangles / kCellsOfSmallMesh),
                 std::min(kLeastPerCell, wanted.triangles_per_cell), wanted.triangles_per_cell);
  if (topology.component_count == 0) {
    return {std::vector<std::uint32_t>(topology.triangle_count(), kNoIndex), 0};
  }
  const Grains grains = grow_grains(topology, options);
  Seeder seeder(topology, grains, options, context);
  seeder.run();
  if (context.cancelled()) return {};
  return grow_triangles(topology, grains, seeder, context);
}

}  // namespace atlas
