#include "libatlas/charts/mesh/fan_pairs.h"

#include <algorithm>

#include "libatlas/core/sort_total.h"

namespace atlas {
namespace {

// A pair costs 1 - cos of its bend, and a triangle that stays alone costs this. So a pair bends by
// at most 104 degrees.
constexpr double kAlone = 0.625;
// A pair of which one triangle must be turned costs this more. A fan that has more triangles along
// the edge than against it, or fewer, often has a sheet that was turned in part.
constexpr double kTurned = 0.1;
// In balance, orientation counts for more. Four walls whose normals alternate look like two cubes
// at a common edge, whose right angles must cost less than two flat pairs.
constexpr double kTurnedInBalance = 1.1;
// Such a pair bends by at most 60 degrees.
constexpr double kTurnedBend = 0.5;
// Of equally flat pairs, those around the solid are taken, as where two cubes share an edge. So the
// partners do not change from one edge to the next.
constexpr double kConvex = 0.02;
// Exchanges that save less than this, or less than this more than another one, are no better. So
// rounding does not decide ties, and a rotated mesh gets the same pairs.
constexpr double kLeastSaving = 1e-4;
// Layers from here on hold triangles that cancel each other.
constexpr std::uint32_t kCancelled = 1u << 31;

}  // namespace

// Coincident triangles of opposite orientation cancel each other: they are the two sides of a fin
// that stands on the surface, and the surface continues beside it. So triangles that do not cancel
// are paired first. There are as many layers of them as the surface has coincident copies here, and
// more layers of those that cancel. Coincident triangles get the same layers at each of their
// edges, so that a copy continues in one copy.
void FanPairing::sort_into_layers(std::vector<FanFace>& faces) {
  for (std::size_t i = 0, j = 0; i < faces.size(); i = j) {
    std::uint32_t forward = 0, count = 0;
    for (; j < faces.size() && faces[j].third == faces[i].third; ++j, ++count) {
      forward += faces[j].forward;
    }
    const bool major = forward > count - forward;
    const std::uint32_t left = major ? 2 * forward - count : count - 2 * forward;
    std::uint32_t majors = 0, minors = 0;
    for (std::size_t k = i; k < j; ++k) {
      const std::uint32_t rank = faces[k].forward == major ? majors++ : left + minors++;
      faces[k].layer = rank < left ? rank : kCancelled + rank - left;
    }
  }
  sort_total(faces.begin(), faces.end(), [](const FanFace& a, const FanFace& b) {
    if (a.layer != b.layer) return a.layer < b.layer;
    return a.third != b.third ? a.third < b.third : a.half_edge < b.half_edge;
  });
}

double FanPairing::turned_cost(const std::vector<FanFace>& faces) const {
  std::size_t forward = 0;
  for (const std::size_t i : members_) forward += faces[i].forward;
  return 2 * forward == members_.size() ? kTurnedInBalance : kTurned;
}

double FanPairing::cost(const FanFace& a, const FanFace& b, double turned) {
  const double bend = 1 + glm::dot(a.wing, b.wing);
  if (a.forward != b.forward) return bend + kConvex * glm::dot(a.normal, b.wing);
  return bend < kTurnedBend ? bend + turned : kNever;
}

double FanPairing::cost_of(std::size_t i, std::size_t j) const {
  return i == j ? kAlone : costs_[i * mates_.size() + j];
}

// Makes the pair (i, j), and a pair of one of those that they leave with another one, if this saves
// more than the best exchange so far.
void FanPairing::consider(std::size_t i, std::size_t j, Exchange& best) const {
  const std::size_t n = mates_.size(), k = mates_[i], l = mates_[j];
  const bool two_left = k != i && l != j;
  const std::size_t left = k != i ? k : l;  // j if none is left
  const double saving = cost_of(i, k) + cost_of(j, l) - cost_of(i, j);
  const auto offer = [&](std::size_t partner, double saved) {
    if (saved > best.saving + kLeastSaving) best = {i, j, left, partner, saved};
  };
  offer(n, saving - (two_left ? 2 * kAlone : left == j ? 0 : kAlone));
  if (two_left) return offer(l, saving - cost_of(k, l));
  if (left == j) return;
  for (std::size_t m = 0; m < n; ++m) {
    if (mates_[m] == m && m != i && m != j) offer(m, saving + kAlone - cost_of(left, m));
  }
}

// Makes the exchange that saves most, and returns whether there is any. Starting from single
// triangles, this first joins the flattest pairs. Then it gives up the flattest pair where two
// others are better together.
bool FanPairing::exchange() {
  const std::size_t n = mates_.size();
  Exchange best{n, n, n, n, 0};
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = i + 1; j < n; ++j) {
      if (mates_[i] != j) consider(i, j, best);
    }
  }
  if (best.i == n) return false;
  const auto free = [&](std::size_t i) { mates_[i] = i; };
  free(mates_[best.i]);
  free(mates_[best.j]);
  const auto join = [&](std::size_t i, std::size_t j) {
    mates_[i] = j;
    mates_[j] = i;
  };
  join(best.i, best.j);
  if (best.partner != n) join(best.left, best.partner);
  return true;
}

}  // namespace atlas
