#include "libatlas/charts/seams/straighten.h"

#include <algorithm>
#include <compare>
#include <vector>

#include "libatlas/charts/seams/straighten_pair.h"
#include "libatlas/core/claims.h"
#include "libatlas/core/pool.h"

namespace atlas {
namespace {

// If all borders together are shorter, threads are not worth their cost.
constexpr std::size_t kFewEdges = 300;

class Straightener {
 public:
  Straightener(const Topology& topology, const StraightenOptions& options, Partition& partition)
      : topology_(topology), options_(options), partition_(partition) {
    gather();
  }

  std::vector<std::uint32_t> run(const Context& context) {
    std::vector<std::uint32_t> places(topology_.triangle_count(), kNoIndex);
    const SharedBands shared{topology_, options_.rules, options_.rings, partition_, places};
    std::vector<std::vector<std::uint32_t>> moved(pairs_.size());
    Pool<PairScratch> pool;
    Context here = context;
    if (half_edges_.size() < kFewEdges) here.threads = 1;
    for_each_claim(here, pairs_, [&](std::size_t i) {
      auto scratch = pool.take();
      const std::span border(&half_edges_[first_[i]], first_[i + 1] - first_[i]);
      moved[i] = straighten_pair(shared, {pairs_[i], border}, *scratch);
      pool.give(std::move(scratch));
    });
    std::vector<std::uint32_t> all;
    for (const auto& part : moved) all.insert(all.end(), part.begin(), part.end());
    return all;
  }

 private:
  struct Border {
    Claims charts;  // smaller, larger
    std::uint32_t half_edge;
    std::strong_ordering operator<=>(const Border&) const = default;
  };

  void gather() {
    std::vector<Border> borders;
    const std::span<const std::uint32_t> triangles = options_.triangles;
    const std::size_t count = triangles.empty() ? topology_.triangle_count() : triangles.size();
    for (std::uint32_t i = 0; i < 3 * count; ++i) {
      const std::uint32_t h = triangles.empty() ? i : 3 * triangles[i / 3] + i % 3;
      const std::uint32_t o = topology_.opposite[h];
      if (o == kNoIndex || o < h) continue;
      const std::uint32_t a = partition_.chart[h / 3], b = partition_.chart[o / 3];
      if (a == b || a == kNoIndex || b == kNoIndex) continue;
      if (options_.rings[a] == 0 || options_.rings[b] == 0) continue;
      borders.push_back({{std::min(a, b), std::max(a, b)}, h});
    }
    std::sort(borders.begin(), borders.end());
    for (const Border& border : borders) {
      if (pairs_.empty() || pairs_.back() != border.charts) {
        pairs_.push_back(border.charts);
        first_.push_back(static_cast<std::uint32_t>(half_edges_.size()));
      }
      half_edges_.push_back(border.half_edge);
    }
    first_.push_back(static_cast<std::uint32_t>(half_edges_.size()));
  }

  const Topology& topology_;
  const StraightenOptions& options_;
  Partition& partition_;
  std::vector<Claims> pairs_;              // pairs of charts
  std::vector<std::uint32_t> half_edges_;  // half-edges on their borders
  std::vector<std::uint32_t> first_;       // one per pair, and the end: index into half_edges_
};

}  // namespace

std::vector<std::uint32_t> straighten_borders(const Topology& topology,
                                              const StraightenOptions& options,
                                              Partition& partition, const Context& context) {
  return Straightener(topology, options, partition).run(context);
}

}  // namespace atlas
