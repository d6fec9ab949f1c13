#include "libatlas/uvs/push_slivers.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <deque>
#include <functional>
#include <glm/geometric.hpp>
#include <limits>
#include <queue>
#include <utility>

#include "libatlas/core/no_index.h"
#include "libatlas/uvs/thin_uvs.h"

namespace atlas {
namespace {

constexpr double kMostPush = 16 * kUvStep;     // the longest move of a corner at a time
constexpr double kMostShift = 2048 * kUvStep;  // the longest move of a corner in all
constexpr std::uint8_t kMostPushes = 50;    // per triangle; what takes more is left to open_stacks
constexpr std::size_t kMostAtPlainUv = 64;  // a uv with more triangles is a hub
// Pushed triangles have just the area they need. At hubs they may lack this share of it before they
// are pushed again; otherwise each of them would be looked at whenever the hub moves at all. The
// area needed is larger by more than that than what rounding takes (open_area()).
constexpr double kLeeway = 1e-3;

// How often the triangles at a hub are looked at because of its moves, on average. Those of a fan
// in shape take a twentieth of this. Where all of a fan is far smaller than the steps between
// floats, each of its triangles closes at every push of another one.
constexpr std::size_t kMostLooks = 2000;

// All triangles at a hub move with it, but hardly. Looking at each of them after each push would
// take time that grows with the square of their number. Each open triangle tells instead how far
// its hub may travel, along whatever path, until the triangle may lack height.
class Hubs {
 public:
  explicit Hubs(const ExactTriangles& triangles)
      : corners_(triangles.corners), hub_of_(triangles.exact.size(), kNoIndex) {
    for (std::uint32_t uv = 0; uv < hub_of_.size(); ++uv) {
      if (triangles.corners_at[uv].size() <= kMostAtPlainUv) continue;
      hub_of_[uv] = std::uint32_t(hubs_.size());
      hubs_.emplace_back().looks_left = kMostLooks * triangles.corners_at[uv].size();
    }
    if (!hubs_.empty()) due_.assign(corners_.size(), kNever);
  }

  bool is_hub(std::uint32_t uv) const { return hub_of_[uv] != kNoIndex; }

  void travel(std::uint32_t uv, double way) {
    if (is_hub(uv)) hubs_[hub_of_[uv]].travelled += way;
  }

  bool at_hub(std::span<const std::uint32_t> c) const {
    return is_hub(c[0]) || is_hub(c[1]) || is_hub(c[2]);
  }

  // Triangle t has twice the area that it needs, plus `spare`. It is due again before that is used
  // up, unless another corner than its hubs moves.
  void defer(std::uint32_t t, double spare, std::span<const glm::dvec2> at) {
    const std::uint32_t* c = &corners_[3 * std::size_t(t)];
    const int count = is_hub(c[0]) + is_hub(c[1]) + is_hub(c[2]);
    // Rounding errors of areas on a page, which is one wide, are far below this.
    spare = std::max(0.0, spare - 1e-15);
    for (std::size_t k = 0; k < 3; ++k) {
      if (!is_hub(c[k])) continue;
      // Moving a corner by d changes twice the area by d times the opposite edge at most, and the
      // area needed by less than 5 steps times d. If several corners move, products of two moves
      // come to these. All hubs together use up less than the spare area.
      const double edge = glm::distance(at[c[(k + 1) % 3]], at[c[(k + 2) % 3]]);
      const double way = std::min(spare / (2 * (edge + 5 * kUvStep)), std::sqrt(spare / 2)) / count;
      Hub& hub = hubs_[hub_of_[c[k]]];
      double& due = due_[3 * std::size_t(t) + k];
      if (due <= hub.travelled + way) continue;
      due = hub.travelled + way / 2;  // early, so that a little less room needs no new entry
      hub.waiting.emplace(due, std::uint32_t(3 * t + k));
    }
  }

  // Lists the triangles at a hub that may lack height by now, unless these were too many already.
  void list_due(std::uint32_t uv, std::vector<std::uint32_t>& triangles) {
    Hub& hub = hubs_[hub_of_[uv]];
    while (hub.looks_left > 0 && !hub.waiting.empty() && hub.waiting.top().first <= hub.travelled) {
      --hub.looks_left;
      const auto [due, corner] = hub.waiting.top();
      hub.waiting.pop();
      if (due != due_[corner]) continue;  // an earlier entry has taken its place
      due_[corner] = kNever;
      triangles.push_back(corner / 3);
    }
  }

 private:
  static constexpr double kNever = std::numeric_limits<double>::infinity();
  using Entry = std::pair<double, std::uint32_t>;  // when it is due, and a corner

  struct Hub {
    double travelled = 0;
    std::size_t looks_left = 0;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> waiting;
  };

  std::span<const std::uint32_t> corners_;
  std::vector<std::uint32_t> hub_of_;  // one per uv, or kNoIndex
  std::vector<Hub> hubs_;
  std::vector<double> due_;  // one per corner; kNever if it does not wait
};

class SliverPusher {
 public:
  SliverPusher(const ExactTriangles& triangles, std::span<const Vec2d> home, double farthest)
      : corners_(triangles.corners),
        corners_at_(triangles.corners_at),
        start_(triangles.exact),
        home_(home),
        farthest_(farthest),
        at_(start_.begin(), start_.end()),
        moved_(start_.size(), 0),
        pushes_(corners_.size() / 3, 0),
        queued_(corners_.size() / 3, 0),
        hubs_(triangles) {}

  PushWork run(std::vector<Vec2f>& uvs) {
    for (std::uint32_t t = 0; t < queued_.size(); ++t) {
      if (is_thin(corners_.subspan(3 * std::size_t(t)).first<3>(), uvs)) {
        enqueue(t);
      } else if (hubs_.at_hub(corners_.subspan(3 * std::size_t(t), 3))) {
        hubs_.defer(t, -lacks(t, kLeeway), at_);
      }
    }
    while (!queue_.empty()) {
      const std::uint32_t t = queue_.front();
      queue_.pop_front();
      queued_[t] = 0;
      if (push(t)) queue_closed(t);
    }
    for (std::size_t i = 0; i < uvs.size(); ++i) {
      if (moved_[i]) uvs[i] = rounded_uv(at_[i]);
    }
    return work_;
  }

 private:
  const std::uint32_t* corners_of(std::uint32_t t) const { return &corners_[3 * std::size_t(t)]; }

  void enqueue(std::uint32_t t) {
    queue_.push_back(t);
    queued_[t] = 1;
  }

  // Returns twice the area that a triangle lacks, beyond a share of what it needs.
  double lacks(std::uint32_t t, double leeway = 0) const {
    const std::uint32_t* c = corners_of(t);
    if (c[0] == c[1] || c[1] == c[2] || c[2] == c[0]) return 0;
    const glm::dvec2 u = at_[c[1]] - at_[c[0]], v = at_[c[2]] - at_[c[0]];
    return (1 - leeway) * open_area(u, v) - (u.x * v.y - u.y * v.x);
  }

  // Queues the triangles at the corners of t that lack height now, corner by corner.
  void queue_closed(std::uint32_t t) {
    const std::uint32_t* c = corners_of(t);
    near_.assign(1, t);
    for (int k = 0; k < 3; ++k) {
      if (hubs_.is_hub(c[k])) {
        hubs_.list_due(c[k], near_);
      } else {
        for (const std::uint32_t corner : corners_at_[c[k]]) near_.push_back(corner / 3);
      }
    }
    std::sort(near_.begin(), near_.end());
    near_.erase(std::unique(near_.begin(), near_.end()), near_.end());
    const auto wanted = [&](std::uint32_t i) { return !queued_[i] && pushes_[i] < kMostPushes; };
    std::erase_if(near_, [&](std::uint32_t i) { return !wanted(i) || !look(i); });
    for (int k = 0; k < 3; ++k) {
      for (const std::uint32_t other : near_) {
        const std::uint32_t* o = corners_of(other);
        if (!queued_[other] && std::find(o, o + 3, c[k]) != o + 3) enqueue(other);
      }
    }
  }

  // Returns whether a triangle is to be pushed.
  bool look(std::uint32_t t) {
    ++work_.looks;
    const bool at_hub = hubs_.at_hub(corners_.subspan(3 * std::size_t(t), 3));
    const double lack = lacks(t, at_hub ? kLeeway : 0);
    if (at_hub && lack <= 0) hubs_.defer(t, -lack, at_);
    return lack > 0;
  }

  // Returns false if the triangle is open already, or has been pushed too often.
  bool push(std::uint32_t t) {
    if (pushes_[t] == kMostPushes) return false;
    const double lack = lacks(t);
    if (lack <= 0) {
      look(t);
      return false;
    }
    const std::uint32_t* c = corners_of(t);
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
      const glm::dvec2 from = at_[c[k]], home = to_glm(home_[c[k]]);
      at_[c[k]] = glm::clamp(from + step, glm::max(start_[c[k]] - kMostShift, home - farthest_),
                             glm::min(start_[c[k]] + kMostShift, home + farthest_));
      hubs_.travel(c[k], glm::distance(from, at_[c[k]]));
      moved_[c[k]] = 1;
    }
    ++pushes_[t];
    ++work_.pushes;
    return true;
  }

  std::span<const std::uint32_t> corners_;
  const Buckets& corners_at_;
  std::span<const glm::dvec2> start_;  // one per uv
  std::span<const Vec2d> home_;
  double farthest_;
  std::vector<glm::dvec2> at_;  // one per uv: where pushing has come to
  std::vector<std::uint8_t> moved_;
  std::vector<std::uint8_t> pushes_, queued_;  // one per triangle
  std::deque<std::uint32_t> queue_;
  Hubs hubs_;
  std::vector<std::uint32_t> near_;  // triangles that the last push may have closed
  PushWork work_;
};

}  // namespace

PushWork push_slivers(const ExactTriangles& triangles, std::span<const Vec2d> home, double farthest,
                      std::vector<Vec2f>& uvs) {
  return SliverPusher(triangles, home, farthest).run(uvs);
}

}  // namespace atlas
