#include "libatlas/param/repair/widen.h"

#include <algorithm>
#include <cmath>

#include "libatlas/core/glm_bridge.h"
#include "libatlas/param/injectivity.h"
#include "libatlas/param/relaxing/relax.h"

namespace atlas {
namespace {

using param::NearParts;
using param::Relaxer;

constexpr int kRounds = 12, kSweeps = 12;
// The share of the missing distance, up to kMore times the clearance, that each side moves. Both
// together move more than is missing, since springs yield.
constexpr double kShare = 0.55, kMore = 1.05;
// If a round leaves more than kWorthIt of what was missing, or exceeds the bound, the share of the
// next one is halved. Rounds end when it is below kLeastShare.
constexpr double kWorthIt = 0.9, kLeastShare = 0.1;
// Triangles within this distance, in clearances, follow; the least and the most rings of them.
constexpr double kFollow = 6, kLeastRings = 3, kMostRings = 24;
// The goal where the bound is exceeded, as a share of the bound.
constexpr double kWithin = 0.999;
constexpr int kHalvings = 3;  // of a move that exceeds the bound

double length_of(const param::HalfEdges::Border& border, const param::HalfEdges& half_edges,
                 std::span<const Vec2d> uvs) {
  double length = 0;
  for (const std::uint32_t h : border.half_edges) {
    length += glm::distance(to_glm(uvs[half_edges.from(h)]), to_glm(uvs[half_edges.to(h)]));
  }
  return length;
}

double length_of(std::span<const NearParts::Place> places) {
  double length = 0;
  for (const NearParts::Place& p : places) length += p.length;
  return length;
}

double missing_in(std::span<const NearParts::Place> places) {
  double missing = 0;
  for (const NearParts::Place& p : places) missing += p.length * p.short_by * p.short_by;
  return missing;
}

class Widener {
 public:
  Widener(const LocalMesh& mesh, const WidenOptions& options, std::span<Vec2d> uvs)
      : mesh_(mesh), options_(options), uvs_(uvs) {
    half_edges_.build(mesh);
    half_edges_.border(border_);
  }

  Widened run() {
    NearParts near(mesh_, {half_edges_, border_}, options_.clearance, uvs_);
    std::span<const NearParts::Place> places = near.find(uvs_);
    Widened result;
    result.border = length_of(border_, half_edges_, uvs_);
    result.near_before = result.near_after = length_of(places);
    if (places.empty()) return result;
    bound_ = std::max(options_.max_stretch, measure_distortion(mesh_, uvs_).stretch_999);
    elements_.build(mesh_, options_.min_altitude);
    corners_.build(elements_, uvs_.size());
    double least = missing_in(places);
    for (int round = 0; round < kRounds && share_ >= kLeastShare && !places.empty(); ++round) {
      before_.assign(uvs_.begin(), uvs_.end());
      pull(places);
      const bool sound = keep_to_bound();
      const std::span<const NearParts::Place> now = near.find(uvs_);
      const double missing = missing_in(now);
      if (!sound || missing > kWorthIt * least) share_ *= 0.5;
      if (!sound || missing >= least) {
        std::copy(before_.begin(), before_.end(), uvs_.begin());
        places = near.find(uvs_);
        continue;
      }
      places = now;
      least = missing;
      result.distortion = now_;
      result.moved = true;
      result.near_after = length_of(places);
    }
    return result;
  }

 private:
  // Makes springs. Both ends of an edge move so that the place on it moves as needed, the nearer
  // one more.
  void collect(std::span<const NearParts::Place> places) {
    springs_.clear();
    longest_.assign(uvs_.size(), 0);
    place_.assign(uvs_.size(), 0);
    const auto draw = [&](std::uint32_t v, double by, glm::dvec2 away) {
      if (by <= longest_[v]) return;
      longest_[v] = by;
      if (place_[v] == 0) {
        springs_.push_back({v, {}});
        place_[v] = static_cast<std::uint32_t>(springs_.size());
      }
      springs_[place_[v] - 1].target = from_glm(to_glm(uvs_[v]) + by * away);
    };
    for (const NearParts::Place& p : places) {
      const double a = 1 - p.along, b = p.along,
                   missing = p.short_by + (kMore - 1) * options_.clearance;
      const double by = share_ * missing / (a * a + b * b);
      draw(half_edges_.from(p.half_edge), a * by, p.away);
      draw(half_edges_.to(p.half_edge), b * by, p.away);
    }
  }

  void pull(std::span<const NearParts::Place> places) {
    collect(places);
    const double edge = length_of(border_, half_edges_, uvs_) / double(border_.half_edges.size());
    const double rings =
        std::clamp(std::ceil(kFollow * options_.clearance / edge), kLeastRings, kMostRings);
    relaxer_.pull(elements_, corners_, {springs_, static_cast<int>(rings), kSweeps}, uvs_);
  }

  bool within_bound() {
    now_ = measure_distortion(mesh_, uvs_);
    return now_.stretch_999 <= bound_;
  }

  // Spreads the stretch of the few triangles around the moved places beyond the bound, first with
  // the border held where it is now, then freely. Then takes back moves as far as necessary.
  // Returns whether the map is valid in the end.
  bool keep_to_bound() {
    constexpr int rings = 10, sweeps = 30;
    constexpr double least_gain = 0.05;
    if (!within_bound()) {
      for (Relaxer::Spring& s : springs_) s.target = uvs_[s.vertex];
      relaxer_.pull(elements_, corners_, {springs_, rings, sweeps, least_gain}, uvs_);
      if (!within_bound()) relaxer_.lower_tail(elements_, corners_, kWithin * bound_, uvs_);
    }
    for (int i = 0; i <= kHalvings; ++i) {
      if (within_bound() && check_injectivity(mesh_, uvs_).injective) return true;
      for (std::size_t v = 0; v < uvs_.size(); ++v) {
        uvs_[v] = {0.5 * (uvs_[v].x + before_[v].x), 0.5 * (uvs_[v].y + before_[v].y)};
      }
    }
    return false;
  }

  const LocalMesh& mesh_;
  const WidenOptions& options_;
  std::span<Vec2d> uvs_;
  std::vector<Vec2d> before_;  // at the start of the round
  Distortion now_;
  double bound_ = 0, share_ = kShare;
  param::HalfEdges half_edges_;
  param::HalfEdges::Border border_;
  param::Elements elements_;
  param::CornerLists corners_;
  Relaxer relaxer_;
  std::vector<Relaxer::Spring> springs_;
  std::vector<double> longest_;       // one per vertex: the length of its spring
  std::vector<std::uint32_t> place_;  // one per vertex: 1 + its spring's index, or 0
};

}  // namespace

Widened measure_mesh_gaps(const LocalMesh& mesh, double clearance, std::span<const Vec2d> uvs) {
  param::HalfEdges half_edges;
  param::HalfEdges::Border border;
  half_edges.build(mesh);
  half_edges.border(border);
  NearParts near(mesh, {half_edges, border}, clearance, uvs);
  Widened result;
  result.border = length_of(border, half_edges, uvs);
  result.near_before = result.near_after = length_of(near.find(uvs));
  return result;
}

Widened widen_mesh_gaps(const LocalMesh& mesh, const WidenOptions& options, std::span<Vec2d> uvs) {
  return Widener(mesh, options, uvs).run();
}

}  // namespace atlas
