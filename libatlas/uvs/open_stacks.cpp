#include "libatlas/uvs/open_stacks.h"

#include <Eigen/Core>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <utility>

#include "libatlas/core/no_index.h"
#include "libatlas/core/portable_math.h"
#include "libatlas/uvs/barrier_hessian.h"
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
    const double gap = d - kFelt, log = portable::log(d / kFelt);
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

  const StackWork& work() const { return work_; }

  // Returns how far each member moves from its exact place.
  std::vector<glm::dvec2> run(double farthest) {
    Vector x = Vector::Zero(Eigen::Index(2 * stack_.members.size()));
    find_pattern(x);
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

  static Eigen::Index index(const Corner& c, int i) {
    return Eigen::Index(2 * std::size_t(c.place)) + i % 2;
  }

  // Lists the entries of the Hessian below the diagonal that some triangle may ever add to, so that
  // they are analysed once.
  void find_pattern(const Vector& x) {
    std::vector<Eigen::Triplet<double>> entries;
    for (int i = 0; i < x.size(); ++i) entries.emplace_back(i, i, 0);
    for (const std::uint32_t t : stack_.triangles) {
      visit_entries(corners(t, x), [&](int, int, Eigen::Index row, Eigen::Index column) {
        entries.emplace_back(int(row), int(column), 0);
      });
    }
    hessian_.resize(x.size(), x.size());
    hessian_.setFromTriplets(entries.begin(), entries.end());
    factor_.analyzePattern(hessian_);
    ++work_.patterns;
    for (const std::uint32_t t : stack_.triangles) {
      slots_.push_back(places_.size());
      visit_entries(corners(t, x), [&](int, int, Eigen::Index row, Eigen::Index column) {
        places_.push_back(std::size_t(&hessian_.coeffRef(row, column) - hessian_.valuePtr()));
      });
    }
  }

  // Calls visit() with the rows and columns of a triangle's own Hessian that belong to members and
  // come to lie on or below the diagonal, and with the row and column where they lie then.
  template <class Visit>
  static void visit_entries(const std::array<Corner, 3>& c, const Visit& visit) {
    for (int j = 0; j < 6; ++j) {
      if (c[std::size_t(j / 2)].place == kNoIndex) continue;
      for (int i = 0; i < 6; ++i) {
        if (c[std::size_t(i / 2)].place == kNoIndex) continue;
        const Eigen::Index row = index(c[std::size_t(i / 2)], i);
        const Eigen::Index column = index(c[std::size_t(j / 2)], j);
        if (row >= column) visit(i, j, row, column);
      }
    }
  }

  // Makes one step of Newton's method, halved until no triangle closes and the energy falls.
  // Returns false if that gains nothing.
  bool descend(Vector& x, double tether) {
    const double weight = 1 / (tether * tether);
    Vector gradient = weight * x;
    hessian_.coeffs().setZero();
    hessian_.diagonal().setConstant(weight);
    for (std::size_t i = 0; i < stack_.triangles.size(); ++i) add_barrier(i, x, gradient);
    factor_.factorize(hessian_);
    ++work_.solves;
    if (factor_.info() != Eigen::Success) return false;
    const Vector step = -factor_.solve(gradient);
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

  // Adds the gradient of a triangle's barrier, and the positive semidefinite part of its Hessian.
  void add_barrier(std::size_t triangle, const Vector& x, Vector& gradient) {
    const auto c = corners(stack_.triangles[triangle], x);
    const double target = targets_[triangle];
    const Barrier barrier(twice_area(c) / target);
    if (barrier.value <= 0) return;
    const double slope = barrier.slope / target;
    Eigen::Matrix<double, 6, 1> g;  // gradient of twice the area
    for (int k = 0; k < 3; ++k) {
      const glm::dvec2 across = c[std::size_t(k + 2) % 3].at - c[std::size_t(k + 1) % 3].at;
      g[2 * k] = -across.y;
      g[2 * k + 1] = across.x;
    }
    for (int i = 0; i < 6; ++i) {
      const Corner& corner = c[std::size_t(i / 2)];
      if (corner.place != kNoIndex) gradient[index(corner, i)] += slope * g[i];
    }
    const auto h = positive_barrier_hessian(g, barrier.curvature / (target * target), -slope);
    const std::size_t* place = places_.data() + slots_[triangle];
    visit_entries(c, [&](int i, int j, Eigen::Index, Eigen::Index) {
      hessian_.valuePtr()[*place++] += h(i, j);
    });
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
  std::vector<double> targets_;          // one per triangle: twice the area wanted, squared steps
  Eigen::SparseMatrix<double> hessian_;  // on and below the diagonal
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor_;
  // Where the entries of all triangles lie among the Hessian's, as visit_entries() goes through
  // them; and one per triangle: the first of its entries there.
  std::vector<std::size_t> places_, slots_;
  StackWork work_;
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

  StackWork run() {
    for (std::uint32_t t = 0; t < in_vain_.size(); ++t) {
      for (int rings = 0; rings <= kMostRings && !in_vain_[t] && thin(t); ++rings) {
        if (moved_ >= kMostInAll) return work_;
        const Stack stack = finder_.find(t, rings, place_);
        open(stack);
        for (const std::uint32_t uv : stack.members) place_[uv] = kNoIndex;
        if (rings < kMostRings) continue;
        in_vain_[t] = 1;
        for (const std::uint32_t other : stack.triangles) in_vain_[other] = 1;
      }
    }
    return work_;
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
    StackOpener opener(corners_, exact_, stack, place_);
    const std::vector<glm::dvec2> moves = opener.run(farthest_);
    work_.patterns += opener.work().patterns;
    work_.solves += opener.work().solves;
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
  StackWork work_;
};

}  // namespace

StackWork open_stacks(const ExactTriangles& triangles, double farthest, std::vector<Vec2f>& uvs) {
  return StackUvs(triangles, farthest, uvs).run();
}

}  // namespace atlas
