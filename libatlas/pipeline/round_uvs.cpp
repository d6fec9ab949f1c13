#include "libatlas/pipeline/round_uvs.h"

#include <algorithm>
#include <deque>
#include <limits>

#include "libatlas/core/counting_sort.h"
#include "libatlas/pipeline/spread_specks.h"
#include "libatlas/pipeline/thin_uvs.h"

namespace atlas {
namespace {

constexpr int kMostSteps = 128;  // that a corner is taken beyond the edge across
constexpr int kMostTries = 32;   // a triangle
// Triangles more that a move may close: in a stack of slivers the outer ones give way in turn.
constexpr int kMostHarm = 1;

class SliverOpener {
 public:
  SliverOpener(std::span<const std::uint32_t> corners, std::vector<Vec2f>& uvs)
      : corners_(corners), uvs_(uvs) {}

  std::size_t run() {
    if (!any_thin()) return 0;
    corners_at_ = sort_into_buckets(corners_.size(), uvs_.size(),
                                    [&](std::size_t corner) { return corners_[corner]; });
    spread_specks(corners_, corners_at_, uvs_);
    const std::size_t n = corners_.size() / 3;
    for (std::uint32_t t = 0; t < n; ++t) {
      if (thin(t)) queue_.push_back(t);
    }
    std::vector<std::uint8_t> tries(n, 0);
    std::vector<std::uint32_t> given_up;
    while (!queue_.empty()) {
      const std::uint32_t t = queue_.front();
      queue_.pop_front();
      if (!thin(t) || tries[t] == kMostTries) continue;
      if (++tries[t] == kMostTries || !open(t)) {
        tries[t] = kMostTries;
        given_up.push_back(t);
      }
    }
    return std::size_t(
        std::count_if(given_up.begin(), given_up.end(), [&](std::uint32_t t) { return thin(t); }));
  }

 private:
  struct Move {
    std::uint32_t uv = 0;
    Vec2f to;
    int harm = std::numeric_limits<int>::max();  // triangles more that are thin
  };

  glm::dvec2 at(std::uint32_t uv) const { return to_dvec(uvs_[uv]); }

  bool thin(std::uint32_t t) const {
    return is_thin(corners_.subspan(3 * std::size_t(t)).first<3>(), uvs_);
  }

  bool any_thin() const {
    for (std::uint32_t t = 0; t < corners_.size() / 3; ++t) {
      if (thin(t)) return true;
    }
    return false;
  }

  int thin_around(std::uint32_t uv) const {
    int count = 0;
    for (const std::uint32_t corner : corners_at_[uv]) count += thin(corner / 3);
    return count;
  }

  // Moves a corner of a thin triangle away from the edge opposite, closing as few others as may be.
  // False if those would be too many.
  bool open(std::uint32_t t) {
    Move best;
    for (int steps = 2; steps <= kMostSteps && best.harm >= 0; steps *= 2) {
      for (int corner = 0; corner < 3; ++corner) consider(t, corner, steps, best);
    }
    if (best.harm > kMostHarm) return false;
    uvs_[best.uv] = best.to;
    for (const std::uint32_t corner : corners_at_[best.uv]) {
      if (corner / 3 != t && thin(corner / 3)) queue_.push_back(corner / 3);
    }
    return true;
  }

  void consider(std::uint32_t t, int corner, int steps, Move& best) {
    const std::uint32_t* c = &corners_[3 * std::size_t(t)];
    const std::uint32_t uv = c[corner];
    const glm::dvec2 p = at(uv), a = at(c[(corner + 1) % 3]), along = at(c[(corner + 2) % 3]) - a;
    const double length = glm::length(along);
    const glm::dvec2 across =
        length > 0 ? glm::dvec2(-along.y, along.x) / length : glm::dvec2(0, 1);
    const double shift = steps * kUvStep - glm::dot(across, p - a);
    if (shift > 2 * kMostSteps * kUvStep) return;  // a short edge, far from the corner
    const glm::vec2 there = glm::clamp(glm::vec2(p + shift * across), 0.0f, 1.0f);
    const Vec2f old = uvs_[uv], to{there.x, there.y};
    const int before = thin_around(uv);
    uvs_[uv] = to;
    const int harm = thin_around(uv) - before + (thin(t) ? 1 : 0);
    uvs_[uv] = old;
    if (harm < best.harm) best = {uv, to, harm};
  }

  std::span<const std::uint32_t> corners_;
  std::vector<Vec2f>& uvs_;
  std::deque<std::uint32_t> queue_;
  Buckets corners_at_;  // each uv
};

}  // namespace

std::size_t round_uvs(std::span<const Vec2d> exact, std::span<const std::uint32_t> corners,
                      std::vector<Vec2f>& rounded) {
  rounded.resize(exact.size());
  for (std::size_t i = 0; i < exact.size(); ++i) {
    rounded[i] = {float(exact[i].x), float(exact[i].y)};
  }
  return SliverOpener(corners, rounded).run();
}

}  // namespace atlas
