#include "libatlas/charts/seams/straighten.h"

#include <algorithm>
#include <cmath>

#include "libatlas/charts/seams/min_cut.h"
#include "libatlas/core/glm_bridge.h"

namespace atlas {
namespace {

constexpr double kSteps = 256;        // a mean edge's length in the cut's integers
constexpr double kLongest = 1 << 16;  // so many steps at most, for 32 bits

class Straightener {
 public:
  Straightener(const Topology& topology, const StraightenOptions& options, Partition& partition,
               Frames& frames)
      : topology_(topology),
        rules_(options.rules),
        bands_(options.bands),
        triangles_(options.triangles),
        partition_(partition),
        frames_(frames),
        crease_cosine_(std::cos(options.rules.crease_degrees * M_PI / 180)) {}

  void run() {
    const std::vector<Border> borders = gather();
    local_.assign(topology_.triangle_count(), kNoIndex);
    for (std::size_t i = 0, j; i < borders.size(); i = j) {
      for (j = i; j < borders.size() && borders[j].key == borders[i].key;) ++j;
      charts_ = {static_cast<std::uint32_t>(borders[i].key >> 32),
                 static_cast<std::uint32_t>(borders[i].key)};
      straighten({borders.data() + i, j - i});
    }
  }

 private:
  struct Border {
    std::uint64_t key;  // smaller chart, larger chart
    std::uint32_t half_edge;
  };

  std::vector<Border> gather() const {
    std::vector<Border> borders;
    const std::size_t count = triangles_.empty() ? topology_.triangle_count() : triangles_.size();
    for (std::uint32_t i = 0; i < 3 * count; ++i) {
      const std::uint32_t h = triangles_.empty() ? i : 3 * triangles_[i / 3] + i % 3;
      const std::uint32_t o = topology_.opposite[h];
      if (o == kNoIndex || o < h) continue;
      const std::uint32_t a = partition_.chart[h / 3], b = partition_.chart[o / 3];
      if (a == b || a == kNoIndex || b == kNoIndex || rings(a, b) == 0) continue;
      borders.push_back({std::uint64_t{std::min(a, b)} << 32 | std::max(a, b), h});
    }
    std::sort(borders.begin(), borders.end(), [](const Border& a, const Border& b) {
      return a.key != b.key ? a.key < b.key : a.half_edge < b.half_edge;
    });
    return borders;
  }

  int rings(std::uint32_t a, std::uint32_t b) const {
    return std::min(bands_[a].rings, bands_[b].rings);
  }

  // 0 or 1: which of the two charts; 2: neither.
  std::uint32_t side(std::uint32_t t) const {
    const std::uint32_t chart = partition_.chart[t];
    return chart == charts_[0] ? 0 : chart == charts_[1] ? 1 : 2;
  }

  void reach(std::uint32_t t) {
    if (local_[t] != kNoIndex || side(t) == 2 || partition_.seams[t]) return;
    local_[t] = static_cast<std::uint32_t>(band_.size());
    band_.push_back(t);
  }

  // Where a cut in the whole band would change too much, one in a narrower band may not.
  void straighten(std::span<const Border> border) {
    int rings = this->rings(charts_[0], charts_[1]);
    do {
      refused_ = false;
      find_band(border, rings);
      for (std::uint32_t first = 0; first < band_.size();) first = straighten_from(first);
      for (const std::uint32_t t : band_) local_[t] = kNoIndex;
      rings /= 2;
    } while (refused_ && rings > 0);
  }

  // The triangles within `rings` of the border, reordered so that what hangs together is adjacent.
  void find_band(std::span<const Border> border, int rings) {
    band_.clear();
    for (const Border& edge : border) {
      const std::uint32_t a = edge.half_edge / 3, b = topology_.opposite[edge.half_edge] / 3;
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
    std::vector<std::uint32_t>& order = scratch_;
    order.clear();
    for (const std::uint32_t seed : band_) {
      if (local_[seed] == kTaken) continue;
      local_[seed] = kTaken;
      order.push_back(seed);
      for (std::size_t i = order.size() - 1; i < order.size(); ++i) {
        for (std::uint32_t h = 3 * order[i]; h < 3 * order[i] + 3; ++h) {
          const std::uint32_t o = topology_.opposite[h];
          if (o == kNoIndex || local_[o / 3] == kNoIndex || local_[o / 3] == kTaken) continue;
          local_[o / 3] = kTaken;
          order.push_back(o / 3);
        }
      }
    }
    band_.swap(order);
    for (std::uint32_t i = 0; i < band_.size(); ++i) local_[band_[i]] = i;
  }

  bool in_band(std::uint32_t t) const {
    return local_[t] != kNoIndex && local_[t] >= first_ && local_[t] < last_;
  }

  // Straightens the part of the band that begins at `first`; returns where the next begins.
  std::uint32_t straighten_from(std::uint32_t first) {
    first_ = first;
    last_ = static_cast<std::uint32_t>(band_.size());
    std::uint32_t end = first + 1;
    for (std::uint32_t i = first; i < end; ++i) {
      for (std::uint32_t h = 3 * band_[i]; h < 3 * band_[i] + 3; ++h) {
        const std::uint32_t o = topology_.opposite[h];
        if (o != kNoIndex && in_band(o / 3)) end = std::max(end, local_[o / 3] + 1);
      }
    }
    last_ = end;
    if (!cut_and_apply()) refused_ = true;
    return end;
  }

  // False if that would have changed more than a border.
  bool cut_and_apply() {
    if (!build_cut()) return false;
    cut_.run();
    bool moved = false;
    for (std::uint32_t i = first_; i < last_; ++i) moved |= changes(band_[i]);
    if (!moved) return true;
    if (!same_euler() || !held()) return false;
    apply();
    return true;
  }

  static std::int32_t steps(double length) {
    return static_cast<std::int32_t>(std::lround(std::min(length, kLongest)));
  }

  // False if one of the charts lies wholly in the band: the shortest border would be none.
  bool build_cut() {
    double mean = 0;
    for (std::uint32_t i = first_; i < last_; ++i) mean += edge_length(topology_, 3 * band_[i]);
    const double unit = mean / (last_ - first_) / kSteps;
    if (!(unit > 0)) return false;
    cut_.reset(last_ - first_);
    const double stiffness = std::max(bands_[charts_[0]].stiffness, bands_[charts_[1]].stiffness);
    bool anchored[2] = {false, false};
    for (std::uint32_t i = first_; i < last_; ++i) {
      const std::uint32_t t = band_[i], own = side(t);
      for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) add_edge(h, unit, anchored);
      const double size = std::sqrt(static_cast<double>(topology_.areas[t]));
      cut_.tie(i - first_, own, steps(stiffness * size / unit));
      if (rules_.cone.excludes(topology_.normals[t], charts_[1 - own]))
        cut_.tie(i - first_, own, MinCut::kForever);
    }
    return anchored[0] && anchored[1];
  }

  void add_edge(std::uint32_t h, double unit, bool (&anchored)[2]) {
    const std::uint32_t o = topology_.opposite[h], i = local_[h / 3] - first_;
    if (o == kNoIndex || partition_.seam(h)) return;
    const bool within = in_band(o / 3);
    if (within && o < h) return;  // one side adds it for both
    const std::int32_t w = steps(border_weight(topology_, h, crease_cosine_) / unit);
    if (within) {
      cut_.set_edge({i, h % 3}, {local_[o / 3] - first_, o % 3}, w);
    } else if (const std::uint32_t there = side(o / 3); there < 2) {
      anchored[there] = true;
      cut_.tie(i, there, w);
    }
  }

  // The number of a chart's vertices, less edges, plus triangles: what changes it closes rings,
  // opens them or divides. Vertices where a chart touches itself count as often as it comes by.
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
    return in_band(t) && cut_.side(local_[t] - first_) != side(t);
  }
  std::uint32_t side_at(std::uint32_t t, bool after) const {
    return after && in_band(t) ? cut_.side(local_[t] - first_) : side(t);
  }
  bool edge_in(std::uint32_t h, std::uint32_t s, bool after) const {
    const std::uint32_t o = topology_.opposite[h];
    return side_at(h / 3, after) == s || (o != kNoIndex && side_at(o / 3, after) == s);
  }
  // Names the fan of triangles around the start of h: its first half-edge in anticlockwise order,
  // the least one if the fan is closed.
  std::uint32_t first_of_fan(std::uint32_t h) const {
    std::uint32_t least = h;
    for (std::uint32_t at = h;;) {
      if (topology_.opposite[at] == kNoIndex) return at;
      at = next_half_edge(topology_.opposite[at]);
      if (at == h) return least;
      least = std::min(least, at);
    }
  }

  // How many vertices of side s a fan holds: as many as there are runs of its triangles.
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

  // Whether all parts of both charts in the band would have a hold outside it. Parts need not hang
  // together within the band: where the characteristics stay, a chart could come apart only if it
  // got a hole as well. (If one does, flattening takes its pieces for charts.)
  bool held() {
    visited_.assign(last_ - first_, 0);
    for (std::uint32_t i = 0; i < visited_.size(); ++i) {
      if (visited_[i]) continue;
      visited_[i] = 1;
      bool hold = false;
      scratch_.assign(1, band_[first_ + i]);
      for (std::size_t k = 0; k < scratch_.size(); ++k) {
        const std::uint32_t t = scratch_[k];
        for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
          const std::uint32_t o = topology_.opposite[h];
          if (o == kNoIndex || partition_.seam(h)) continue;
          if (side_at(o / 3, true) != side_at(t, true)) continue;
          if (!in_band(o / 3)) {
            hold = true;
          } else if (std::uint8_t& seen = visited_[local_[o / 3] - first_]; !seen) {
            seen = 1;
            scratch_.push_back(o / 3);
          }
        }
      }
      if (!hold) return false;
    }
    return true;
  }

  // Triangles change sides, each with a frame from a neighbour that was there before or has
  // changed already.
  void apply() {
    scratch_.clear();
    for (std::uint32_t i = first_; i < last_; ++i) {
      if (changes(band_[i])) scratch_.push_back(band_[i]);
    }
    for (std::size_t left = scratch_.size(); left > 0;) {
      std::size_t kept = 0;
      for (std::size_t k = 0; k < left; ++k) {
        const std::uint32_t t = scratch_[k], h = way_over(t);
        if (h == kNoIndex) {
          scratch_[kept++] = t;
        } else {
          move_triangle(topology_, h, partition_, frames_);
        }
      }
      if (kept == left) break;  // cannot be: held() has seen a way to each
      left = kept;
    }
  }

  // A half-edge of t to a triangle of the chart that t changes to.
  std::uint32_t way_over(std::uint32_t t) const {
    const std::uint32_t to = charts_[cut_.side(local_[t] - first_)];
    for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
      const std::uint32_t o = topology_.opposite[h];
      if (o != kNoIndex && partition_.chart[o / 3] == to) return h;
    }
    return kNoIndex;
  }

  static constexpr std::uint32_t kTaken = kNoIndex - 1;

  const Topology& topology_;
  const BorderRules& rules_;
  std::span<const SeamBand> bands_;
  std::span<const std::uint32_t> triangles_;
  Partition& partition_;
  Frames& frames_;
  double crease_cosine_;
  std::array<std::uint32_t, 2> charts_;
  std::vector<std::uint32_t> band_, local_, scratch_, fans_;
  std::vector<std::uint8_t> visited_;   // 1 a triangle of the part
  std::uint32_t first_ = 0, last_ = 0;  // the part of band_ that is at work
  bool refused_ = false;                // a cut in the band at hand
  MinCut cut_;
};

}  // namespace

void straighten_borders(const Topology& topology, const StraightenOptions& options,
                        Partition& partition, Frames& frames) {
  Straightener(topology, options, partition, frames).run();
}

}  // namespace atlas
