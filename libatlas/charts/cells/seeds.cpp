#include "libatlas/charts/cells/seeds.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <utility>

#include "libatlas/charts/cells/cell_distance.h"
#include "libatlas/charts/cells/ring_queue.h"
#include "libatlas/charts/cells/tips.h"
#include "libatlas/core/degrees.h"
#include "libatlas/core/sort_total.h"

namespace atlas {
namespace {

constexpr double kFlatSpread = 1e-6;
constexpr std::uint32_t kCalmGrain = 3;
// Keeps round cosines away from the limits between parts.
constexpr float kBetweenParts = 0.29f;
constexpr float kCosineParts = 4096;
constexpr std::uint32_t kStretch = 64;  // grains per block of farthest_
// In a large piece the first seeds are scattered: they are more than kHops grains apart, one for
// some twenty grains, and make up at most kScatteredShare of its cells. Once seeds are well spaced,
// growing from the farthest point stays local, whereas with few seeds it covers most of the piece.
// This takes half of the time of sampling and gives as many charts with seams as long (100 meshes,
// ten segmentations each). It is not done in pieces with handles or holes, which would get a third
// more charts.
constexpr std::uint8_t kHops = 3, kNotCovered = 0xff;
constexpr double kScatteredShare = 0.8;
constexpr std::uint32_t kManyCells = 16;

struct Visit {
  std::uint32_t key;  // of the distance
  float distance;
  std::uint32_t node, seed;
};

// Chooses seeds among the grains.
class Seeder {
 public:
  Seeder(const CellInput& input, const Grains& grains, const CellOptions& options,
         const Context& context)
      : topology_(input.topology),
        plan_(input.plan),
        grains_(grains),
        options_(options),
        context_(context) {}

  CellSeeds run() {
    distance_.assign(grains_.count(), kFar);
    owner_.assign(grains_.count(), kNoIndex);
    for (std::uint32_t first = 0, last = 0; first < grains_.count() && !context_.cancelled();
         first = last) {
      while (last < grains_.count() && grains_.component[last] == grains_.component[first]) ++last;
      const std::size_t first_seed = seeds_.size();
      double area = 0;
      for (std::uint32_t g = first; g < last; ++g) area += grains_.area[g];
      ruler_ = CellRuler(area, last - first);
      const std::uint32_t budget = flat(first, last) ? 1 : plan_.cells[grains_.component[first]];
      sample_piece(first, last, budget);
      if (context_.cancelled()) break;  // grains beyond the border of a region may have no seed
      if (seeds_.size() == first_seed + 1) continue;
      number_by_grain(first, last, first_seed);
      for (int round = 0; round < 2; ++round) recentre(first, last, first_seed);
    }
    return {std::move(seeds_), std::move(normals_), std::move(owner_)};
  }

 private:
  // Whether a piece lies in one plane. It is then one chart whatever its outline, so one cell will
  // do.
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
    seeds_.push_back(grain);
    normals_.push_back(grains_.normal[grain]);
    queue_.restart();
    start_from(grain, static_cast<std::uint32_t>(seeds_.size() - 1));
    spread();
  }

  void start_from(std::uint32_t grain, std::uint32_t seed) {
    if (ruler_.take(0, seed, distance_[grain], owner_[grain])) {
      queue_.push({0, distance_[grain], grain, seed});
    }
  }

  void spread() {
    // Local copies of what is read repeatedly, which the compiler knows that no write changes.
    const CellRuler ruler = ruler_;
    const std::uint32_t *const first = grains_.first.data(), *const neighbour =
                                                                 grains_.neighbour.data();
    const float* const step = grains_.distance.data();
    const glm::vec3* const normal = grains_.normal.data();
    float* const nearest = distance_.data();
    std::uint32_t* const owner = owner_.data();
    while (!queue_.empty()) {
      const Visit visit = queue_.pop();
      if (visit.distance != nearest[visit.node] || visit.seed != owner[visit.node]) continue;
      const glm::vec3 axis = normals_[visit.seed];
      for (std::uint32_t i = first[visit.node], end = first[visit.node + 1]; i < end; ++i) {
        const std::uint32_t next = neighbour[i];
        const float distance = visit.distance + cell_distance(step[i], normal[next], axis);
        if (!ruler.take(distance, visit.seed, nearest[next], owner[next])) continue;
        queue_.push({std::max(ruler.key(distance), visit.key), nearest[next], next, visit.seed});
      }
    }
  }

  void sample_piece(std::uint32_t first, std::uint32_t last, std::uint32_t budget) {
    farthest_.assign((last - first + kStretch - 1) / kStretch, kFar);
    const std::size_t first_seed = seeds_.size();
    const auto start = static_cast<std::uint32_t>(options_.first_seed * (last - first));
    if (budget < kManyCells || plan_.pierced[grains_.component[first]]) {
      add_seed(first + start);
    } else {
      scatter(first, last, start, static_cast<std::uint32_t>(kScatteredShare * budget));
    }
    while (!context_.cancelled()) {
      const std::uint32_t grain = farthest(first, last);
      if (distance_[grain] == kFar) ++budget;  // beyond the border of a face
      if (distance_[grain] == 0 || seeds_.size() - first_seed >= budget) break;
      add_seed(grain);
    }
    if (!context_.cancelled()) add_leaning(first, last, first_seed);
  }

  // Scatters seeds in the order of the grains, starting with the start-th, each where no other seed
  // is within kHops.
  void scatter(std::uint32_t first, std::uint32_t last, std::uint32_t start, std::uint32_t most) {
    const std::uint32_t n = last - first;
    hops_.assign(n, kNotCovered);
    queue_.restart();
    for (std::uint32_t i = 0, count = 0; i < n && count < most; ++i) {
      const std::uint32_t g = first + (start + i) % n;
      if (hops_[g - first] != kNotCovered) continue;
      cover(first, g);
      seeds_.push_back(g);
      normals_.push_back(grains_.normal[g]);
      start_from(g, static_cast<std::uint32_t>(seeds_.size() - 1));
      ++count;
    }
    spread();
  }

  // Marks, breadth-first, the grains within kHops of the seed that are not as near to another one.
  void cover(std::uint32_t first, std::uint32_t seed) {
    hops_[seed - first] = 0;
    reached_.assign(1, seed);
    for (std::size_t i = 0; i < reached_.size(); ++i) {
      const std::uint32_t g = reached_[i];
      const auto hops = static_cast<std::uint8_t>(hops_[g - first] + 1);
      if (hops > kHops) return;
      for (std::uint32_t k = grains_.first[g]; k < grains_.first[g + 1]; ++k) {
        std::uint8_t& known = hops_[grains_.neighbour[k] - first];
        if (known <= hops) continue;
        known = hops;
        reached_.push_back(grains_.neighbour[k]);
      }
    }
  }

  // Returns the last of the grains that are farthest from all seeds. Distances only fall while
  // seeds are added, so the remembered maximum of each block of grains is an upper bound, and few
  // blocks have to be searched again.
  std::uint32_t farthest(std::uint32_t first, std::uint32_t last) {
    const auto end_of = [&](std::size_t s) {
      return std::min<std::uint32_t>(last, first + kStretch * static_cast<std::uint32_t>(s + 1));
    };
    const auto look_again = [&](std::size_t s) {
      // The bits of non-negative floats order as the numbers do, and compilers compare four
      // integers at once.
      std::int32_t most = 0;
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
      if (!ruler_.about_as_far(farthest_[s], most)) continue;
      for (std::uint32_t g = end_of(s); g-- > first + kStretch * std::uint32_t(s);) {
        if (ruler_.about_as_far(distance_[g], most)) return g;
      }
      look_again(s);
    }
    return first;  // not reached: the farthest grain itself passes the test
  }

  // Renumbers the seeds of a piece by their grains, the last grain's seed first. They were found in
  // an order that rounding decides where several are about equally far from all others, and ties
  // are broken by number.
  void number_by_grain(std::uint32_t first, std::uint32_t last, std::size_t first_seed) {
    const auto begin = static_cast<std::uint32_t>(first_seed);
    std::vector<std::uint32_t> order(seeds_.size() - first_seed), number(order.size());
    std::iota(order.begin(), order.end(), begin);
    sort_total(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
      return std::pair(seeds_[a], a) > std::pair(seeds_[b], b);
    });
    const std::vector<std::uint32_t> old_seeds(seeds_.begin() + begin, seeds_.end());
    const std::vector<glm::vec3> old_normals(normals_.begin() + begin, normals_.end());
    for (std::uint32_t i = 0; i < order.size(); ++i) {
      number[order[i] - begin] = begin + i;
      seeds_[begin + i] = old_seeds[order[i] - begin];
      normals_[begin + i] = old_normals[order[i] - begin];
    }
    for (std::uint32_t g = first; g < last; ++g) owner_[g] = number[owner_[g] - begin];
  }

  // Adds seeds where a grain's normal deviates too far from that of its seed, worst first, in up to
  // six rounds. A piece that unrolls gets no more seeds than any piece is planned to have, since
  // its cells unroll however much they are bent. In a corrugated sheet each quad became a cell,
  // and merging took a thousand times as long (24 576 triangles: 44 s).
  void add_leaning(std::uint32_t first, std::uint32_t last, std::size_t first_seed) {
    const auto limit = static_cast<float>(cosine_of(options_.max_lean_degrees));
    const auto cosine = [&](std::uint32_t g) {
      return glm::dot(calm_normal(g), normals_[owner_[g]]);
    };
    std::size_t most =
        std::max<std::size_t>(seeds_.size() - first_seed, options_.max_cells_per_piece);
    std::vector<std::uint8_t> look(last - first, 1);
    for (int round = 0; round < 6; ++round) {
      std::vector<std::pair<int, std::uint32_t>> leaning;
      for (std::uint32_t g = first; g < last; ++g) {
        if (!look[g - first]) continue;
        const float c = cosine(g);
        if (c < limit)
          leaning.push_back({static_cast<int>(std::floor(kCosineParts * c + kBetweenParts)), g});
      }
      if (leaning.empty()) return;
      std::sort(leaning.begin(), leaning.end());
      const std::vector<std::uint32_t> before(owner_.begin() + first, owner_.begin() + last);
      for (const auto& [worst, g] : leaning) {
        if (context_.cancelled()) return;
        if (cosine(g) >= limit) continue;
        if (seeds_.size() - first_seed == most) {
          if (developable(topology_, plan_.pieces.of(grains_.component[first]))) return;
          most = kNoIndex;
        }
        add_seed(g);
      }
      find_changed(first, before, look);
      // A grain may have got another seed before its turn.
      for (const auto& [worst, g] : leaning) look[g - first] = 1;
    }
  }

  // Marks the grains that got another seed, and their neighbours. All others deviate as before.
  void find_changed(std::uint32_t first, const std::vector<std::uint32_t>& before,
                    std::vector<std::uint8_t>& changed) const {
    std::fill(changed.begin(), changed.end(), 0);
    for (std::uint32_t g = first; g < first + before.size(); ++g) {
      if (owner_[g] == before[g - first]) continue;
      changed[g - first] = 1;
      for (std::uint32_t i = grains_.first[g]; i < grains_.first[g + 1]; ++i) {
        changed[grains_.neighbour[i] - first] = 1;
      }
    }
  }

  // Returns a grain's normal. For a grain of several triangles, this is averaged with the
  // neighbouring grains of its cell, since the normals of a few triangles may deviate by noise
  // alone.
  glm::vec3 calm_normal(std::uint32_t g) const {
    if (grains_.size[g] < kCalmGrain) return grains_.normal[g];
    glm::vec3 sum = grains_.area[g] * grains_.normal[g];
    for (std::uint32_t i = grains_.first[g]; i < grains_.first[g + 1]; ++i) {
      const std::uint32_t n = grains_.neighbour[i];
      if (owner_[n] != owner_[g]) continue;  // it may lie beyond a crease
      sum += grains_.area[n] * grains_.normal[n];
    }
    return unit_or(sum, grains_.normal[g]);
  }

  void recentre(std::uint32_t first, std::uint32_t last, std::size_t first_seed) {
    struct Sum {
      // In double: single precision would decide near ties.
      glm::dvec3 middle{0}, normal{0};
      double area = 0;
      float best = kFar;
    };
    std::vector<Sum> sums(seeds_.size() - first_seed);
    for (std::uint32_t g = first; g < last; ++g) {
      Sum& sum = sums[owner_[g] - first_seed];
      sum.middle += double(grains_.area[g]) * glm::dvec3(grains_.centroid[g]);
      sum.normal += double(grains_.area[g]) * glm::dvec3(grains_.normal[g]);
      sum.area += grains_.area[g];
    }
    for (Sum& sum : sums) sum.middle /= sum.area;
    for (std::uint32_t g = first; g < last; ++g) {
      Sum& sum = sums[owner_[g] - first_seed];
      const auto d = static_cast<float>(glm::distance(glm::dvec3(grains_.centroid[g]), sum.middle));
      if (ruler_.shorter(d, sum.best)) {
        sum.best = d;
        seeds_[owner_[g]] = g;
      }
      distance_[g] = kFar;
    }
    queue_.restart();
    for (std::size_t s = first_seed; s < seeds_.size(); ++s) {
      const glm::dvec3& normal = sums[s - first_seed].normal;
      const double length = glm::length(normal);
      if (length > 0) normals_[s] = normal / length;
      start_from(seeds_[s], static_cast<std::uint32_t>(s));
    }
    spread();
  }

  const Topology& topology_;
  const CellPlan& plan_;
  const Grains& grains_;
  const CellOptions& options_;
  const Context& context_;
  std::vector<std::uint32_t> seeds_;  // grains
  std::vector<glm::vec3> normals_;    // one per seed
  std::vector<float> distance_;
  std::vector<std::uint32_t> owner_;
  std::vector<float> farthest_;     // one per block of the piece's grains: no grain is farther
  std::vector<std::uint8_t> hops_;  // one per grain of the piece: steps to the nearest scattered
                                    // seed
  std::vector<std::uint32_t> reached_;  // by cover()
  CellRuler ruler_;                     // of the current piece
  RingQueue<Visit> queue_;
};

}  // namespace

CellSeeds choose_seeds(const CellInput& input, const Grains& grains, const CellOptions& options,
                       const Context& context) {
  return Seeder(input, grains, options, context).run();
}

}  // namespace atlas
