#include "libatlas/uvs/round_uvs.h"

#include <deque>

#include "libatlas/core/counting_sort.h"
#include "libatlas/uvs/open_stacks.h"
#include "libatlas/uvs/spread_specks.h"
#include "libatlas/uvs/thin_uvs.h"

namespace atlas {
namespace {

constexpr double kMostPush = 16 * kUvStep;     // the longest move of a corner at a time
constexpr double kMostShift = 2048 * kUvStep;  // the longest move of a corner in all
constexpr std::uint8_t kMostPushes = 50;  // per triangle; what takes more is left to open_stacks

// Pushes thin triangles open one at a time, and in turn those that this closes (position-based
// dynamics, Müller et al. 2007). A corner moves in proportion to the length of the opposite edge,
// so the two near corners of a sliver are parted.
class SliverOpener {
 public:
  SliverOpener(std::span<const std::uint32_t> corners, std::span<const Vec2d> exact,
               double farthest, std::vector<Vec2f>& uvs)
      : corners_(corners), exact_(exact), farthest_(farthest), uvs_(uvs) {}

  // Returns how many triangles stay thin.
  std::size_t run() {
    if (count_thin() == 0) return 0;
    corners_at_ = sort_into_buckets(corners_.size(), uvs_.size(),
                                    [&](std::size_t corner) { return corners_[corner]; });
    for (const Vec2d& p : exact_) start_.push_back(to_glm(p));
    push_open();
    open_stacks({corners_, corners_at_, start_}, farthest_, uvs_);
    if (count_thin() == 0) return 0;
    spread_specks(corners_, corners_at_, uvs_);
    for (std::size_t i = 0; i < uvs_.size(); ++i) start_[i] = to_dvec(uvs_[i]);
    push_open();
    return count_thin();
  }

 private:
  bool thin(std::uint32_t t) const {
    return is_thin(corners_.subspan(3 * std::size_t(t)).first<3>(), uvs_);
  }

  std::size_t count_thin() const {
    std::size_t count = 0;
    for (std::uint32_t t = 0; t < corners_.size() / 3; ++t) count += thin(t);
    return count;
  }

  // Starts from start_.
  void push_open() {
    at_ = start_;
    moved_.assign(uvs_.size(), 0);
    const std::size_t n = corners_.size() / 3;
    std::vector<std::uint8_t> pushes(n, 0);
    std::vector<std::uint8_t> queued(n, 0);
    std::deque<std::uint32_t> queue;
    for (std::uint32_t t = 0; t < n; ++t) {
      if (!thin(t)) continue;
      queue.push_back(t);
      queued[t] = 1;
    }
    while (!queue.empty()) {
      const std::uint32_t t = queue.front();
      queue.pop_front();
      queued[t] = 0;
      if (pushes[t] == kMostPushes || !push(t)) continue;
      ++pushes[t];
      for (int k = 0; k < 3; ++k) {
        for (const std::uint32_t corner : corners_at_[corners_[3 * std::size_t(t) + k]]) {
          const std::uint32_t other = corner / 3;
          if (queued[other] || lacks(other) <= 0) continue;
          queue.push_back(other);
          queued[other] = 1;
        }
      }
    }
    for (std::size_t i = 0; i < uvs_.size(); ++i) {
      if (moved_[i]) uvs_[i] = rounded_uv(at_[i]);
    }
  }

  // Returns twice the area that a triangle lacks.
  double lacks(std::uint32_t t) const {
    const std::uint32_t* c = &corners_[3 * std::size_t(t)];
    if (c[0] == c[1] || c[1] == c[2] || c[2] == c[0]) return 0;
    const glm::dvec2 u = at_[c[1]] - at_[c[0]], v = at_[c[2]] - at_[c[0]];
    return open_area(u, v) - (u.x * v.y - u.y * v.x);
  }

  // Returns false if the triangle is open already.
  bool push(std::uint32_t t) {
    const double lack = lacks(t);
    if (lack <= 0) return false;
    const std::uint32_t* c = &corners_[3 * std::size_t(t)];
    glm::dvec2 gradient[3];  // of twice the area
    double sum = 0;
    for (int k = 0; k < 3; ++k) {
      const glm::dvec2 across = at_[c[(k + 2) % 3]] - at_[c[(k + 1) % 3]];
      gradient[k] = {-across.y, across.x};
      sum += glm::dot(across, across);
    }
    for (int k = 0; k < 3; ++k) {
      glm::dvec2 step = sum > 0 ? lack / sum * gradient[k] : glm::dvec2(0);
      const double length = glm::length(step);
      if (length > kMostPush) step *= kMostPush / length;
      glm::dvec2& p = at_[c[k]];
      const glm::dvec2 home = to_glm(exact_[c[k]]);
      p = glm::clamp(p + step, glm::max(start_[c[k]] - kMostShift, home - farthest_),
                     glm::min(start_[c[k]] + kMostShift, home + farthest_));
      moved_[c[k]] = 1;
    }
    return true;
  }

  std::span<const std::uint32_t> corners_;
  std::span<const Vec2d> exact_;
  double farthest_;
  std::vector<Vec2f>& uvs_;
  Buckets corners_at_;                  // the corners at each uv
  std::vector<glm::dvec2> start_, at_;  // one per uv: where pushing starts, and has come to
  std::vector<std::uint8_t> moved_;
};

}  // namespace

std::size_t round_uvs(std::span<const Vec2d> exact, std::span<const std::uint32_t> corners,
                      std::vector<Vec2f>& rounded, double farthest) {
  rounded.resize(exact.size());
  // rounded_uv() clamps uvs to the page: charts at its edge may leave it by the rounding error of
  // their turn.
  for (std::size_t i = 0; i < exact.size(); ++i) rounded[i] = rounded_uv(to_glm(exact[i]));
  return SliverOpener(corners, exact, farthest, rounded).run();
}

}  // namespace atlas
