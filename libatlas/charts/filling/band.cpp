#include "libatlas/charts/filling/band.h"

#include <cmath>
#include <limits>

namespace atlas {
namespace {

constexpr int kDirections = 8;
constexpr double kReach = 0.3;  // radians to either side of a direction
constexpr double kNoWay = std::numeric_limits<double>::infinity();

// A corner as seen from the middle.
struct Seen {
  std::uint32_t uv;
  double angle;
};

std::vector<Seen> look_around(std::span<const Vec2d> uvs, std::span<const std::uint32_t> border,
                              const Vec2d& middle) {
  std::vector<Seen> seen;
  for (const std::uint32_t i : border) {
    seen.push_back({i, std::atan2(uvs[i].y - middle.y, uvs[i].x - middle.x)});
  }
  return seen;
}

BandCrossing shortest_way(std::span<const Vec2d> uvs, std::span<const Seen> outer,
                          std::span<const Seen> inner, double direction) {
  const auto near = [&](const Seen& s) {
    return std::abs(std::remainder(s.angle - direction, 2 * M_PI)) < kReach;
  };
  BandCrossing shortest{0, 0, kNoWay};
  for (const Seen& o : outer) {
    if (!near(o)) continue;
    for (const Seen& i : inner) {
      if (!near(i)) continue;
      const double length = std::hypot(uvs[o.uv].x - uvs[i.uv].x, uvs[o.uv].y - uvs[i.uv].y);
      if (length < shortest.length) shortest = {o.uv, i.uv, length};
    }
  }
  return shortest;
}

}  // namespace

std::vector<BandCrossing> cross_band(std::span<const Vec2d> uvs,
                                     std::span<const std::uint32_t> outer,
                                     std::span<const std::uint32_t> inner) {
  Vec2d middle{0, 0};
  for (const std::uint32_t i : inner) {
    middle.x += uvs[i].x / double(inner.size());
    middle.y += uvs[i].y / double(inner.size());
  }
  const std::vector<Seen> outside = look_around(uvs, outer, middle),
                          inside = look_around(uvs, inner, middle);
  std::vector<BandCrossing> best;
  double least = kNoWay;
  for (int i = 0; i < kDirections; ++i) {
    const double direction = M_PI * i / kDirections;
    const BandCrossing one = shortest_way(uvs, outside, inside, direction),
                       other = shortest_way(uvs, outside, inside, direction + M_PI);
    if (one.length + other.length >= least) continue;
    least = one.length + other.length;
    best = {one, other};
  }
  return best;
}

}  // namespace atlas
