#include "libatlas/charts/filling/line_cut.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "libatlas/charts/geometry/hull.h"

namespace atlas {
namespace {

constexpr double kStray = 0.5;      // what lies at the end of the band counts for longer by this
constexpr double kUnits = 1 << 14;  // weights are integers: the longest edge's

}  // namespace

LineCutter::LineCutter(const FlatChart& chart, const param::HalfEdges& half_edges,
                       std::span<const std::uint32_t> triangles)
    : chart_(chart),
      half_edges_(half_edges),
      triangles_(triangles),
      place_(chart.triangles.size(), kNoIndex),
      along_(triangles.size()),
      side_(triangles.size()),
      node_(triangles.size()) {
  for (std::uint32_t i = 0; i < triangles.size(); ++i) {
    place_[triangles[i]] = i;
    for (std::uint32_t h = 3 * triangles[i]; h < 3 * triangles[i] + 3; ++h) {
      longest_ = std::max(longest_, length_of(h));
    }
  }
  face(0);
}

void LineCutter::face(double angle) {
  const double x = std::cos(angle), y = std::sin(angle);
  for (std::uint32_t i = 0; i < triangles_.size(); ++i) {
    along_[i] = 0;
    for (const std::uint32_t v : chart_.corners[triangles_[i]]) {
      along_[i] += (x * chart_.uvs[v].x + y * chart_.uvs[v].y) / 3;
    }
  }
  const auto [low, high] = std::minmax_element(along_.begin(), along_.end());
  low_ = *low;
  high_ = *high;
}

LineCut LineCutter::cut(double line, double band, double crumb) {
  LineCut cut;
  if (!(band > 0)) return cut;
  find_sides(line, band);
  cut.parts = parts();
  if (move_crumbs(cut.parts, crumb)) cut.parts = parts();
  if (cut.parts.size() < 2) return {};
  for (std::uint32_t i = 0; i < triangles_.size(); ++i) {
    for (std::uint32_t h = 3 * triangles_[i]; h < 3 * triangles_[i] + 3; ++h) {
      const std::uint32_t j = across(h);
      if (j != kNoIndex && i < j && side_[i] != side_[j]) cut.length += length_of(h);
    }
  }
  return cut;
}

double LineCutter::length_of(std::uint32_t h) const {
  const Vec2d &a = chart_.uvs[half_edges_.from(h)], &b = chart_.uvs[half_edges_.to(h)];
  return std::hypot(b.x - a.x, b.y - a.y);
}

// Place of the triangle across h in the piece, or kNoIndex.
std::uint32_t LineCutter::across(std::uint32_t h) const {
  const std::uint32_t o = half_edges_.opposite(h);
  return o == kNoIndex ? kNoIndex : place_[o / 3];
}

void LineCutter::find_sides(double line, double band) {
  std::vector<std::uint32_t> inside;
  for (std::uint32_t i = 0; i < triangles_.size(); ++i) {
    side_[i] = along_[i] > line;
    node_[i] = kNoIndex;
    if (std::abs(along_[i] - line) >= band) continue;
    node_[i] = std::uint32_t(inside.size());
    inside.push_back(i);
  }
  min_cut_.reset(std::uint32_t(inside.size()));
  for (const std::uint32_t i : inside) {
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t h = 3 * triangles_[i] + k, j = across(h);
      if (j == kNoIndex) continue;
      const double off = std::min(1.0, std::abs((along_[i] + along_[j]) / 2 - line) / band);
      const auto weight = static_cast<std::int32_t>(1 + kUnits * length_of(h) / longest_ *
                                                            (1 + kStray * off * off));
      if (node_[j] == kNoIndex) {
        min_cut_.tie(node_[i], side_[j], weight);
      } else if (i < j) {
        min_cut_.set_edge({node_[i], k}, {node_[j], half_edges_.opposite(h) % 3}, weight);
      }
    }
  }
  min_cut_.run();
  for (const std::uint32_t i : inside) side_[i] = std::uint8_t(min_cut_.side(node_[i]));
}

// Connected triangles of one side each.
std::vector<LineCut::Part> LineCutter::parts() const {
  std::vector<LineCut::Part> parts;
  std::vector<std::uint8_t> seen(triangles_.size(), 0);
  for (std::uint32_t first = 0; first < triangles_.size(); ++first) {
    if (seen[first]) continue;
    seen[first] = 1;
    std::vector<std::uint32_t> part{first};
    for (std::size_t k = 0; k < part.size(); ++k) {
      const std::uint32_t i = part[k];
      for (std::uint32_t h = 3 * triangles_[i]; h < 3 * triangles_[i] + 3; ++h) {
        const std::uint32_t j = across(h);
        if (j == kNoIndex || seen[j] || side_[i] != side_[j]) continue;
        seen[j] = 1;
        part.push_back(j);
      }
    }
    std::sort(part.begin(), part.end());
    for (std::uint32_t& i : part) i = triangles_[i];
    parts.push_back({std::move(part), side_[first] != 0});
  }
  return parts;
}

// To the other side; whether there were any.
bool LineCutter::move_crumbs(const std::vector<LineCut::Part>& parts, double crumb) {
  bool moved = false;
  for (const LineCut::Part& part : parts) {
    double area = 0;
    for (const std::uint32_t t : part.triangles) {
      const auto& c = chart_.corners[t];
      area += 0.5 * cross(chart_.uvs[c[0]], chart_.uvs[c[1]], chart_.uvs[c[2]]);
    }
    if (area >= crumb) continue;
    for (const std::uint32_t t : part.triangles) side_[place_[t]] ^= 1;
    moved = true;
  }
  return moved;
}

}  // namespace atlas
