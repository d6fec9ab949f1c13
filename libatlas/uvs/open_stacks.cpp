#include "libatlas/uvs/open_stacks.h"

#include <Eigen/Dense>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <utility>

#include "libatlas/core/no_index.h"
#include "libatlas/uvs/thin_uvs.h"

namespace atlas {
namespace {

// The most uvs of one stack, and of all stacks together. 1000 uvs take a second at the most.
constexpr std::size_t kMostMembers = 1000, kMostInAll = 20000;
// How far a uv may go from its exact place for an energy of a half, in steps between floats. These
// are tried in turn.
constexpr std::array kTethers{8.0, 32.0, 128.0, 512.0, 2048.0, 8192.0};
// A stack that does not open by itself is tried together with up to this many rings of triangles
// around it.
constexpr int kMostRings = 3;
constexpr int kMostSolves = 40;  // per tether
constexpr int kMostHalvings = 30;
// Triangles feel the barrier if their height is below this, where 1 is the height that they should
// get.
constexpr double kFelt = 2;

struct Stack {
  std::vector<std::uint32_t> members;    // uvs
  std::vector<std::uint32_t> triangles;  // those with a member as a corner, unless turned over
};

// The value and the derivatives of the barrier at height d.
struct Barrier {
  double value = 0, slope = 0, curvature = 0;

  explicit Barrier(double d) {
    if (d >= kFelt) return;
    const double gap = d - kFelt, log = std::log(d / kFelt);
    value = -gap * gap * log;
    slope = -2 * gap * log - gap * gap / d;
    curvature = -2 * log - 4 * gap / d + gap * gap / (d * d);
  }
};

class StackOpener {
 public:
  // The moves of all members, in steps between floats.
  using Vector = Eigen::VectorXd;

  StackOpener(std::span<const std::uint32_t> corners, std::span<const glm::dvec2> exact,
              const Stack& stack, std::vector<std::uint32_t>& place)
      : corners_(corners), exact_(exact), stack_(stack), place_(place) {
    origin_ = exact[stack.members.front()];
  }

  // Returns how far each member moves from its exact place.
  std::vector<glm::dvec2> run(double farthest) {
    Vector x = Vector::Zero(Eigen::Index(2 * stack_.members.size()));
    for (const double tether : kTethers) {
      if (tether * kUvStep > farthest) break;
      find_targets(x);
      for (int i = 0; i < kMostSolves; ++i) {
        if (all_open(x)) return moves(x);
        if (!descend(x, tether)) break;
      }
    }
    return moves(x);
  }

 private:
  struct Corner {
    glm::dvec2 at;
    std::uint32_t place;  // among the members, or kNoIndex
  };

  std::array<Corner, 3> corners(std::uint32_t t, const Vector& x) const {
    std::array<Corner, 3> c;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t uv = corners_[3 * std::size_t(t) + k], place = place_[uv];
      c[k] = {(exact_[uv] - origin_) / kUvStep, place};
      if (place != kNoIndex) c[k].at += glm::dvec2(x[2 * place], x[2 * place + 1]);
    }
    return c;
  }

  static double twice_area(const std::array<Corner, 3>& c) {
    const glm::dvec2 u = c[1].at - c[0].at, v = c[2].at - c[0].at;
    return u.x * v.y - u.y * v.x;
  }

  static double wanted_area(const std::array<Corner, 3>& c) {
    const glm::dvec2 u = (c[1].at - c[0].at) * kUvStep, v = (c[2].at - c[0].at) * kUvStep;
    return open_area(u, v) / (kUvStep * kUvStep);
  }

  void find_targets(const Vector& x) {
    targets_.clear();
    for (const std::uint32_t t : stack_.triangles) targets_.push_back(wanted_area(corners(t, x)));
  }

  bool all_open(const Vector& x) const {
    return std::all_of(stack_.triangles.begin(), stack_.triangles.end(), [&](std::uint32_t t) {
      const auto c = corners(t, x);
      return twice_area(c) >= wanted_area(c);
    });
  }

  // Returns infinity if some triangle has no area.
  double energy(const Vector& x, double tether) const {
    double sum = x.squaredNorm() / (2 * tether * tether);
    for (std::size_t i = 0; i < stack_.triangles.size(); ++i) {
      const double d = twice_area(corners(stack_.triangles[i], x)) / targets_[i];
      if (!(d > 0)) return std::numeric_limits<double>::infinity();
      sum += Barrier(d).value;
    }
    return sum;
  }

  // Makes one step of Newton's method, halved until no triangle closes and the energy falls.
  // Returns false if that gains nothing.
  bool descend(Vector& x, double tether) const {
    const double weight = 1 / (tether * tether);
    Vector gradient = weight * x;
    std::vector<Eigen::Triplet<double>> entries;
    for (int i = 0; i < x.size(); ++i) entries.emplace_back(i, i, weight);
    for (std::size_t i = 0; i < stack_.triangles.size(); ++i) {
      add_barrier(corners(stack_.triangles[i], x), targets_[i], gradient, entries);
    }
    Eigen::SparseMatrix<double> hessian(x.size(), x.size());
    hessian.setFromTriplets(entries.begin(), entries.end());
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(hessian);
    if (factor.info() != Eigen::Success) return false;
    const Vector step = -factor.solve(gradient);
    const double slope = gradient.dot(step), before = energy(x, tether);
    double share = 1;
    for (int i = 0; i < kMostHalvings; ++i, share /= 2) {
      const Vector there = x + share * step;
      if (!(energy(there, tether) <= before + 1e-4 * share * slope)) continue;
      x = there;
      return -share * slope > 1e-9 * before;
    }
    return false;
  }

  // Adds the gradient of the barrier, and the positive semidefinite part of its Hessian.
  static void add_barrier(const std::array<Corner, 3>& c, double target, Vector& gradient,
                          std::vector<Eigen::Triplet<double>>& entries) {
    const Barrier barrier(twice_area(c) / target);
    if (barrier.value <= 0) return;
    Eigen::Matrix<double, 6, 1> g;  // gradient of the height
    for (int k = 0; k < 3; ++k) {
      const glm::dvec2 across = c[std::size_t(k + 2) % 3].at - c[std::size_t(k + 1) % 3].at;
      g[2 * k] = -across.y / target;
      g[2 * k + 1] = across.x / target;
    }
    Eigen::Matrix<double, 6, 6> h = barrier.curvature * g * g.transpose();
    for (int k = 0; k < 3; ++k) {
      // The second derivatives of the cross product of corners k and k + 1.
      const int p = 2 * k, q = 2 * ((k + 1) % 3);
      const double part = barrier.slope / target;
      h(p, q + 1) += part;
      h(q + 1, p) += part;
      h(p + 1, q) -= part;
      h(q, p + 1) -= part;
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>> eigen(h);
    h = eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0).asDiagonal() *
        eigen.eigenvectors().transpose();
    for (int i = 0; i < 6; ++i) {
      const std::uint32_t row = c[std::size_t(i / 2)].place;
      if (row == kNoIndex) continue;
      gradient[2 * row + std::uint32_t(i % 2)] += barrier.slope * g[i];
      for (int j = 0; j < 6; ++j) {
        const std::uint32_t column = c[std::size_t(j / 2)].place;
        if (column == kNoIndex) continue;
        entries.emplace_back(int(2 * row) + i % 2, int(2 * column) + j % 2, h(i, j));
      }
    }
  }

  std::vector<glm::dvec2> moves(const Vector& x) const {
    std::vector<glm::dvec2> moves;
    for (std::size_t i = 0; i < stack_.members.size(); ++i) {
      moves.emplace_back(x[Eigen::Index(2 * i)] * kUvStep, x[Eigen::Index(2 * i + 1)] * kUvStep);
    }
    return moves;
  }

  std::span<const std::uint32_t> corners_;
  std::span<const glm::dvec2> exact_;
  const Stack& stack_;
  std::vector<std::uint32_t>& place_;  // one per uv: its place among the members, or kNoIndex
  glm::dvec2 origin_;
  std::vector<double> targets_;  // one per triangle: twice the area wanted, squared steps
};

class StackFinder {
 public:
  explicit StackFinder(const ExactTriangles& triangles)
      : corners_(triangles.corners), corners_at_(triangles.corners_at), exact_(triangles.exact) {}

  // Returns the stack of triangle t: all triangles that lack height and are connected to it through
  // uvs, and `rings` more rings of triangles around them.
  Stack find(std::uint32_t t, int rings, std::vector<std::uint32_t>& place) const {
    Stack stack;
    const auto add = [&](std::uint32_t triangle) {
      for (const std::uint32_t uv : corners_of(triangle)) {
        if (place[uv] != kNoIndex) continue;
        place[uv] = std::uint32_t(stack.members.size());
        stack.members.push_back(uv);
      }
    };
    add(t);
    std::size_t inner = 0;  // number of members whose triangles are listed
    for (int ring = 0; ring <= rings; ++ring) {
      const std::vector<std::uint32_t> known = stack.triangles;
      for (const std::uint32_t triangle : known) add(triangle);
      for (; inner < stack.members.size() && inner < kMostMembers; ++inner) {
        for (const std::uint32_t corner : corners_at_[stack.members[inner]]) {
          const std::uint32_t other = corner / 3;
          const auto [twice, least] = areas(other);
          if (twice > 0) stack.triangles.push_back(other);
          if (twice > 0 && twice < least) add(other);
        }
      }
    }
    std::sort(stack.triangles.begin(), stack.triangles.end());
    stack.triangles.erase(std::unique(stack.triangles.begin(), stack.triangles.end()),
                          stack.triangles.end());
    return stack;
  }

 private:
  std::span<const std::uint32_t, 3> corners_of(std::uint32_t t) const {
    return corners_.subspan(3 * std::size_t(t)).first<3>();
  }

  // Returns twice the exact area of a triangle, and what that should be; 0 for points and lines.
  std::pair<double, double> areas(std::uint32_t t) const {
    const auto c = corners_of(t);
    if (c[0] == c[1] || c[1] == c[2] || c[2] == c[0]) return {0, 0};
    const glm::dvec2 u = exact_[c[1]] - exact_[c[0]], v = exact_[c[2]] - exact_[c[0]];
    return {u.x * v.y - u.y * v.x, open_area(u, v)};
  }

  std::span<const std::uint32_t> corners_;
  const Buckets& corners_at_;
  std::span<const glm::dvec2> exact_;
};

class StackUvs {
 public:
  StackUvs(const ExactTriangles& triangles, double farthest, std::vector<Vec2f>& uvs)
      : corners_(triangles.corners),
        exact_(triangles.exact),
        farthest_(farthest),
        uvs_(uvs),
        finder_(triangles),
        place_(uvs.size(), kNoIndex),
        in_vain_(triangles.corners.size() / 3, 0) {}

  void run() {
    for (std::uint32_t t = 0; t < in_vain_.size(); ++t) {
      for (int rings = 0; rings <= kMostRings && !in_vain_[t] && thin(t); ++rings) {
        if (moved_ >= kMostInAll) return;
        const Stack stack = finder_.find(t, rings, place_);
        open(stack);
        for (const std::uint32_t uv : stack.members) place_[uv] = kNoIndex;
        if (rings < kMostRings) continue;
        in_vain_[t] = 1;
        for (const std::uint32_t other : stack.triangles) in_vain_[other] = 1;
      }
    }
  }

 private:
  bool thin(std::uint32_t t) const {
    return is_thin(corners_.subspan(3 * std::size_t(t)).first<3>(), uvs_);
  }

  // Moves the uvs of a stack, if fewer triangles are thin then.
  void open(const Stack& stack) {
    if (stack.members.size() > kMostMembers) return;
    const auto count_thin = [&] {
      return std::count_if(stack.triangles.begin(), stack.triangles.end(),
                           [&](std::uint32_t t) { return thin(t); });
    };
    const auto before = count_thin();
    const std::vector<glm::dvec2> moves =
        StackOpener(corners_, exact_, stack, place_).run(farthest_);
    moved_ += moves.size();
    for (const glm::dvec2& move : moves)
      if (std::max(std::fabs(move.x), std::fabs(move.y)) > farthest_) return;
    std::vector<Vec2f> old;
    for (std::size_t i = 0; i < moves.size(); ++i) {
      const std::uint32_t uv = stack.members[i];
      old.push_back(uvs_[uv]);
      uvs_[uv] = rounded_uv(exact_[uv] + moves[i]);
    }
    if (count_thin() < before) return;
    for (std::size_t i = 0; i < old.size(); ++i) uvs_[stack.members[i]] = old[i];
  }

  std::span<const std::uint32_t> corners_;
  std::span<const glm::dvec2> exact_;
  double farthest_;
  std::vector<Vec2f>& uvs_;
  StackFinder finder_;
  std::vector<std::uint32_t> place_;   // one per uv
  std::vector<std::uint8_t> in_vain_;  // one per triangle: was tried in vain
  std::size_t moved_ = 0;
};

}  // namespace

void open_stacks(const ExactTriangles& triangles, double farthest, std::vector<Vec2f>& uvs) {
  StackUvs(triangles, farthest, uvs).run();
}

}  // namespace atlas
