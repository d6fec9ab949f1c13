#include "libatlas/charts/seams/refine.h"

#include <algorithm>
#include <cmath>

#include "libatlas/charts/mesh/border_weight.h"
#include "libatlas/charts/mesh/chart_fans.h"
#include "libatlas/core/degrees.h"
#include "libatlas/core/glm_bridge.h"

namespace atlas {
namespace {

class Smoother {
 public:
  Smoother(const Topology& topology, const BorderRules& rules, Partition& partition, Frames& frames)
      : topology_(topology),
        cone_(rules.cone),
        partition_(partition),
        frames_(frames),
        crease_angle_(radians(rules.crease_degrees)) {}

  void run() {
    const auto n = static_cast<std::uint32_t>(topology_.triangle_count());
    queued_.assign(n, 0);
    std::vector<std::uint32_t> now;
    for (std::uint32_t t = 0; t < n; ++t) {
      if (partition_.chart[t] != kNoIndex && at_border(t)) now.push_back(t);
    }
    for (int round = 0; round < kMaxRounds && !now.empty(); ++round) {
      next_.clear();
      for (const std::uint32_t t : now) queued_[t] = 0;
      for (const std::uint32_t t : now) improve(t);
      now.swap(next_);
      std::sort(now.begin(), now.end());
    }
  }

 private:
  static constexpr int kMaxRounds = 64;  // a seam moves by at most this many triangles

  bool at_border(std::uint32_t t) const {
    for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
      const std::uint32_t o = topology_.opposite[h];
      if (o != kNoIndex && partition_.chart[o / 3] != partition_.chart[t]) return true;
    }
    return false;
  }

  void improve(std::uint32_t t) {
    const std::uint32_t own = partition_.chart[t];
    double kept = 0, weights[3] = {0, 0, 0};
    std::uint32_t labels[3];
    for (int c = 0; c < 3; ++c) {
      const std::uint32_t h = 3 * t + c, o = topology_.opposite[h];
      labels[c] = o == kNoIndex || partition_.seam(h) ? kNoIndex : partition_.chart[o / 3];
      if (labels[c] == kNoIndex) continue;
      weights[c] = border_weight(topology_, h, crease_angle_);
      if (labels[c] == own) kept += weights[c];
    }
    int best = -1;
    double best_gain = 1e-9 * (weights[0] + weights[1] + weights[2]);
    for (int c = 0; c < 3; ++c) {
      if (labels[c] == kNoIndex || labels[c] == own ||
          cone_.excludes(topology_.normals[t], labels[c]))
        continue;
      double gained = 0;
      for (int d = 0; d < 3; ++d) gained += labels[d] == labels[c] ? weights[d] : 0;
      if (gained - kept > best_gain) {
        best_gain = gained - kept;
        best = c;
      }
    }
    if (best < 0 || !removable(topology_, partition_, t)) return;
    move_triangle(topology_, 3 * t + static_cast<std::uint32_t>(best), partition_, frames_);
    push(t);
    for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
      if (topology_.opposite[h] != kNoIndex) push(topology_.opposite[h] / 3);
    }
  }

  void push(std::uint32_t t) {
    if (queued_[t]) return;
    queued_[t] = 1;
    next_.push_back(t);
  }

  const Topology& topology_;
  const ConeLimit& cone_;
  Partition& partition_;
  Frames& frames_;
  double crease_angle_;
  std::vector<std::uint8_t> queued_;
  std::vector<std::uint32_t> next_;
};

}  // namespace

bool ConeLimit::excludes(const Vec3f& normal, std::uint32_t chart) const {
  return !axes.empty() && glm::dot(to_dvec(normal), to_dvec(axes[chart])) < least_cosine;
}

Frames::Frame carry_frame(const Topology& topology, const Frames::Frame& frame, std::uint32_t from,
                          std::uint32_t to) {
  const auto wide = [](const Vec3f& v) { return from_glm(to_dvec(v)); };
  return Frames::turned({wide(frame[0]), wide(frame[1])}, wide(topology.normals[from]),
                        wide(topology.normals[to]));
}

void carry_frames(const Topology& topology, std::span<const std::uint32_t> half_edges,
                  Frames& frames) {
  if (frames.empty()) return;
  for (const std::uint32_t h : half_edges) {
    const std::uint32_t t = h / 3, from = topology.opposite[h] / 3;
    frames.put(t, carry_frame(topology, frames.at(topology, from), from, t));
  }
}

void move_triangle(const Topology& topology, std::uint32_t h, Partition& partition,
                   Frames& frames) {
  const std::uint32_t t = h / 3;
  partition.chart[t] = partition.chart[topology.opposite[h] / 3];
  carry_frames(topology, {&h, 1}, frames);
  for (std::uint32_t g = 3 * t; g < 3 * t + 3; ++g) {
    if (!partition.seam(g)) continue;
    const std::uint32_t o = topology.opposite[g];
    partition.close(o);
  }
  partition.seams[t] = 0;
}

bool removable(const Topology& topology, const Partition& partition, std::uint32_t t) {
  const ChartFans fans(topology, partition);
  int links = 0;
  std::uint32_t open = 0;
  for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
    if (fans.linked(h)) {
      ++links;
    } else {
      open = h;
    }
  }
  if (links <= 1) return true;
  if (links == 3) return false;
  // The two links meet at the corner opposite to the open edge. Walks the fan there from one link
  // to the other, without passing t.
  const std::uint32_t start = previous_half_edge(open);
  std::uint32_t h = topology.opposite[previous_half_edge(start)];
  while (h / 3 != t) {
    const std::uint32_t back = previous_half_edge(h);
    if (!fans.linked(back)) return false;
    h = topology.opposite[back];
  }
  return true;
}

void smooth_borders(const Topology& topology, const BorderRules& rules, Partition& partition,
                    Frames& frames) {
  Smoother(topology, rules, partition, frames).run();
}

}  // namespace atlas
