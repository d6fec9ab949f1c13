#include "libatlas/charts/seams/straighten_pair.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <utility>

#include "libatlas/charts/mesh/border_weight.h"
#include "libatlas/core/degrees.h"
#include "libatlas/core/glm_bridge.h"

namespace atlas {
namespace {

constexpr double kCutSteps = 256;     // the length of a mean edge in the cut's integers
constexpr double kLongest = 1 << 16;  // the most steps of an edge, so that sums fit 32 bits

// Triangles at a hub, where more than kHubTriangles meet, stay in their chart. A band of one ring
// would hold the whole fan, and a cut in it would give a sector to what lies across the rim, which
// flattens with neither: a toothed wheel took 8 s for charts that have to be divided again. The
// triangles of a hub are needles: their longest edge squared exceeds kNeedle times twice their
// area.
constexpr int kHubTriangles = 128;
constexpr double kNeedle = 16;

// Where more triangles meet, no cut moves one of them: each would walk around all others. A flat
// fan of so many consists of needles.
constexpr int kMostAround = 1024;

class PairStraightener {
 public:
  PairStraightener(const SharedBands& shared, const BorderPair& pair, PairScratch& scratch)
      : topology_(shared.topology),
        rules_(shared.rules),
        rings_(shared.rings),
        partition_(shared.partition),
        places_(shared.places),
        crease_angle_(radians(shared.rules.crease_degrees)),
        charts_(pair.charts),
        border_(pair.border),
        band_(scratch.band),
        list_(scratch.list),
        fans_(scratch.fans),
        cut_(scratch.cut) {}

  // Where a cut in the whole band would change too much, a cut in a narrower band may not.
  std::vector<std::uint32_t> run() {
    int rings = std::min(rings_[charts_[0]], rings_[charts_[1]]);
    do {
      refused_ = false;
      find_band(rings);
      for (std::uint32_t first = 0; first < band_.size();) first = straighten_from(first);
      for (const std::uint32_t t : band_) places_[t] = kNoIndex;
      rings /= 2;
    } while (refused_ && rings > 0);
    return std::move(moved_);
  }

 private:
  // Returns the chart of any triangle. Atomic, since other threads may move their triangles
  // meanwhile.
  std::uint32_t chart(std::uint32_t t) const {
    return std::atomic_ref(partition_.chart[t]).load(std::memory_order_relaxed);
  }

  // Returns which of the two charts the triangle is in, 0 or 1; 2: neither.
  std::uint32_t side(std::uint32_t t) const {
    const std::uint32_t own = chart(t);
    return own == charts_[0] ? 0 : own == charts_[1] ? 1 : 2;
  }

  // Returns the triangle's index in the band; kNoIndex: not in the band.
  std::uint32_t place(std::uint32_t t) const { return side(t) == 2 ? kNoIndex : places_[t]; }

  // Adds t to the band, with the rest of its polygon, unless it lies at a seam of its chart with
  // itself, or at a hub.
  void reach(std::uint32_t t) {
    const std::size_t first = band_.size();
    reach_one(t);
    if (topology_.polygon.empty()) return;
    for (std::size_t i = first; i < band_.size(); ++i) {
      for (std::uint32_t h = 3 * band_[i]; h < 3 * band_[i] + 3; ++h)
        if (topology_.inner(h)) reach_one(topology_.opposite[h] / 3);
    }
  }

  void reach_one(std::uint32_t t) {
    if (side(t) == 2 || places_[t] != kNoIndex || partition_.seams[t] || at_hub(t)) return;
    places_[t] = static_cast<std::uint32_t>(band_.size());
    band_.push_back(t);
  }

  bool at_hub(std::uint32_t t) const {
    double shortest = std::numeric_limits<double>::infinity(), longest = 0;
    std::uint32_t apex = 3 * t;  // half-edge that begins across the shortest edge
    for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
      const double length = edge_length(topology_, h);
      longest = std::max(longest, length);
      if (length >= shortest) continue;
      shortest = length;
      apex = previous_half_edge(h);
    }
    if (longest * longest <= kNeedle * 2 * double(topology_.areas[t])) return false;
    return triangles_around(apex, kHubTriangles) >= kHubTriangles;
  }

  // Returns the number of triangles around the start of h, or `most` if that is less.
  int triangles_around(std::uint32_t h, int most) const {
    int count = 1;
    std::uint32_t at = topology_.opposite[previous_half_edge(h)];
    for (; at != kNoIndex && at != h && count < most; ++count)
      at = topology_.opposite[previous_half_edge(at)];
    if (at == h) return count;
    for (at = topology_.opposite[h]; at != kNoIndex && count < most; ++count)
      at = topology_.opposite[next_half_edge(at)];
    return count;
  }

  // Finds the triangles within `rings` of the border, ordered by connected components.
  void find_band(int rings) {
    band_.clear();
    for (const std::uint32_t h : border_) {
      const std::uint32_t a = h / 3, b = topology_.opposite[h] / 3;
      if (side(a) + side(b) != 1) continue;  // an earlier pair has changed it
      reach(a);
      reach(b);
    }
    std::size_t begin = 0;
    for (int ring = 1; ring < rings; ++ring) {
      const std::size_t end = band_.size();
      for (; begin < end; ++begin) {
        for (std::uint32_t h = 3 * band_[begin]; h < 3 * band_[begin] + 3; ++h) {
          const std::uint32_t o = topology_.opposite[h];
          if (o != kNoIndex) reach(o / 3);
        }
      }
    }
    order_by_component();
  }

  void order_by_component() {
    std::vector<std::uint32_t>& order = list_;
    order.clear();
    for (const std::uint32_t seed : band_) {
      if (places_[seed] == kTaken) continue;
      places_[seed] = kTaken;
      order.push_back(seed);
      for (std::size_t i = order.size() - 1; i < order.size(); ++i) {
        for (std::uint32_t h = 3 * order[i]; h < 3 * order[i] + 3; ++h) {
          const std::uint32_t o = topology_.opposite[h];
          if (o == kNoIndex || place(o / 3) == kNoIndex || places_[o / 3] == kTaken) continue;
          places_[o / 3] = kTaken;
          order.push_back(o / 3);
        }
      }
    }
    band_.swap(order);
    for (std::uint32_t i = 0; i < band_.size(); ++i) places_[band_[i]] = i;
  }

  bool in_band(std::uint32_t t) const {
    const std::uint32_t at = place(t);
    return at != kNoIndex && at >= first_ && at < last_;
  }

  // Straightens the component of the band that begins at `first`. Returns where the next one
  // begins.
  std::uint32_t straighten_from(std::uint32_t first) {
    first_ = first;
    last_ = static_cast<std::uint32_t>(band_.size());
    std::uint32_t end = first + 1;
    for (std::uint32_t i = first; i < end; ++i) {
      for (std::uint32_t h = 3 * band_[i]; h < 3 * band_[i] + 3; ++h) {
        const std::uint32_t o = topology_.opposite[h];
        if (o != kNoIndex && in_band(o / 3)) end = std::max(end, places_[o / 3] + 1);
      }
    }
    last_ = end;
    if (!cut_and_apply()) refused_ = true;
    return end;
  }

  // Returns false if the cut would have changed more than a border.
  bool cut_and_apply() {
    if (!build_cut()) return false;
    cut_.run();
    bool moved = false;
    for (std::uint32_t i = first_; i < last_; ++i) moved |= changes(band_[i]);
    if (!moved) return true;
    if (!same_euler()) return false;
    apply();
    return true;
  }

  static std::int32_t steps(double length) {
    return static_cast<std::int32_t>(std::lround(std::min(length, kLongest)));
  }

  // Returns false if the band contains all of one of the charts: the shortest border would be
  // empty.
  bool build_cut() {
    double mean = 0;
    for (std::uint32_t i = first_; i < last_; ++i) mean += edge_length(topology_, 3 * band_[i]);
    const double unit = mean / (last_ - first_) / kCutSteps;
    if (!(unit > 0)) return false;
    cut_.reset(last_ - first_);
    bool anchored[2] = {false, false};
    for (std::uint32_t i = first_; i < last_; ++i) {
      const std::uint32_t t = band_[i], own = side(t);
      for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) add_edge(h, unit, anchored);
      cut_.tie(i - first_, own, 1);  // of equal borders, the one that moves the fewest triangles
      if (rules_.cone.excludes(topology_.normals[t], charts_[1 - own]))
        cut_.tie(i - first_, own, MinCut::kForever);
    }
    return anchored[0] && anchored[1];
  }

  void add_edge(std::uint32_t h, double unit, bool (&anchored)[2]) {
    const std::uint32_t o = topology_.opposite[h], i = places_[h / 3] - first_;
    if (o == kNoIndex) return;
    const bool within = in_band(o / 3);
    if (within && o < h) return;  // added once for both directions
    const std::int32_t w = topology_.inner(h)
                               ? MinCut::kForever
                               : steps(border_weight(topology_, h, crease_angle_) / unit);
    if (within) {
      cut_.set_edge({i, h % 3}, {places_[o / 3] - first_, o % 3}, w);
    } else if (const std::uint32_t there = side(o / 3); there < 2) {
      anchored[there] = true;
      cut_.tie(i, there, w);
    }
  }

  // Whether both charts keep their Euler characteristics: vertices minus edges plus triangles. A
  // change means that a chart closes to a ring, opens, or comes apart. A vertex where a chart
  // touches itself counts once for each time.
  bool same_euler() {
    int change[2] = {0, 0};
    fans_.clear();
    for (std::uint32_t i = first_; i < last_; ++i) {
      const std::uint32_t t = band_[i];
      if (!changes(t)) continue;
      const std::uint32_t was = side(t);
      ++change[1 - was];
      --change[was];
      for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
        const std::uint32_t o = topology_.opposite[h];
        if (o == kNoIndex || !changes(o / 3) || h < o) {
          for (std::uint32_t s = 0; s < 2; ++s) {
            change[s] -= edge_in(h, s, true) - edge_in(h, s, false);
          }
        }
        fans_.push_back(first_of_fan(h));
        if (fans_.back() == kNoIndex) return false;
      }
    }
    std::sort(fans_.begin(), fans_.end());
    fans_.erase(std::unique(fans_.begin(), fans_.end()), fans_.end());
    for (const std::uint32_t fan : fans_) {
      for (std::uint32_t s = 0; s < 2; ++s)
        change[s] += runs_in_fan(fan, s, true) - runs_in_fan(fan, s, false);
    }
    return change[0] == 0 && change[1] == 0;
  }

  bool changes(std::uint32_t t) const {
    return in_band(t) && cut_.side(places_[t] - first_) != side(t);
  }
  std::uint32_t side_at(std::uint32_t t, bool after) const {
    return after && in_band(t) ? cut_.side(places_[t] - first_) : side(t);
  }
  bool edge_in(std::uint32_t h, std::uint32_t s, bool after) const {
    const std::uint32_t o = topology_.opposite[h];
    return side_at(h / 3, after) == s || (o != kNoIndex && side_at(o / 3, after) == s);
  }
  // Returns a name for the fan of triangles around the start of h: its first half-edge in
  // counter-clockwise order, or the smallest one if the fan is closed; kNoIndex if that is too far
  // away.
  std::uint32_t first_of_fan(std::uint32_t h) const {
    std::uint32_t least = h, at = h;
    for (int count = 0; count < kMostAround; ++count) {
      if (topology_.opposite[at] == kNoIndex) return at;
      at = next_half_edge(topology_.opposite[at]);
      if (at == h) return least;
      least = std::min(least, at);
    }
    return kNoIndex;
  }

  // Returns how many vertices of side s a fan contains: one for each run of triangles on that side.
  int runs_in_fan(std::uint32_t first, std::uint32_t s, bool after) const {
    int triangles = 0, links = 0;
    bool closed = false;
    for (std::uint32_t h = first; !closed;) {
      const bool in = side_at(h / 3, after) == s;
      triangles += in;
      const std::uint32_t back = previous_half_edge(h), o = topology_.opposite[back];
      if (o == kNoIndex) break;
      links += in && side_at(o / 3, after) == s && !partition_.seam(back);
      h = o;
      closed = h == first;
    }
    return closed && triangles > 0 && links == triangles ? 1 : triangles - links;
  }

  // Moves triangles to the other chart, each across an edge to a triangle that was there before or
  // has moved already. These triangles have no seam bits.
  void apply() {
    list_.clear();
    for (std::uint32_t i = first_; i < last_; ++i) {
      if (changes(band_[i])) list_.push_back(band_[i]);
    }
    for (std::size_t left = list_.size(); left > 0;) {
      std::size_t kept = 0;
      for (std::size_t k = 0; k < left; ++k) {
        const std::uint32_t t = list_[k], h = way_over(t);
        if (h == kNoIndex) {
          list_[kept++] = t;
        } else {
          std::atomic_ref(partition_.chart[t])
              .store(chart(topology_.opposite[h] / 3), std::memory_order_relaxed);
          moved_.push_back(h);
        }
      }
      if (kept == left) break;  // what is left leads nowhere, and stays
      left = kept;
    }
  }

  // Returns a half-edge of t towards the chart that t changes to.
  std::uint32_t way_over(std::uint32_t t) const {
    const std::uint32_t to = charts_[cut_.side(places_[t] - first_)];
    for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
      const std::uint32_t o = topology_.opposite[h];
      if (o != kNoIndex && chart(o / 3) == to) return h;
    }
    return kNoIndex;
  }

  static constexpr std::uint32_t kTaken = kNoIndex - 1;

  const Topology& topology_;
  const BorderRules& rules_;
  std::span<const std::uint8_t> rings_;
  Partition& partition_;
  std::span<std::uint32_t> places_;
  double crease_angle_;
  std::array<std::uint32_t, 2> charts_;
  std::span<const std::uint32_t> border_;
  std::vector<std::uint32_t>&band_, &list_, &fans_;
  MinCut& cut_;
  std::vector<std::uint32_t> moved_;
  std::uint32_t first_ = 0, last_ = 0;  // range of the current component in band_
  bool refused_ = false;                // a cut in the current band was
};

}  // namespace

std::vector<std::uint32_t> straighten_pair(const SharedBands& shared, const BorderPair& pair,
                                           PairScratch& scratch) {
  return PairStraightener(shared, pair, scratch).run();
}

}  // namespace atlas
