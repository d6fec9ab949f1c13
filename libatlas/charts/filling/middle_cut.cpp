#include "libatlas/charts/filling/middle_cut.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "libatlas/charts/filling/chords.h"
#include "libatlas/charts/geometry/hull.h"
#include "libatlas/charts/seams/min_cut.h"

namespace atlas {
namespace {

constexpr int kDirections = 4;  // over half a turn, from the chart's long side on
constexpr std::array<double, 3> kPlaces{0.5, 0.33,
                                        0.67};  // along the piece; the first is the middle
// A cut stays within this share of the piece's length to either side of its line. What lies at the
// end of that counts for half as long again: of equal ways the straight one is taken.
constexpr double kBand = 0.15, kStray = 0.5;
constexpr double kUnits = 1 << 14;  // weights are integers: the longest edge's

using Triangles = std::vector<std::uint32_t>;

class MiddleCutter {
 public:
  MiddleCutter(const FlatChart& chart, const param::HalfEdges& half_edges,
               std::span<const std::uint32_t> triangles, double crumb)
      : chart_(chart), half_edges_(half_edges), triangles_(triangles), crumb_(crumb) {
    place_.assign(chart.triangles.size(), kNoIndex);
    for (std::uint32_t i = 0; i < triangles.size(); ++i) {
      place_[triangles[i]] = i;
      for (std::uint32_t h = 3 * triangles[i]; h < 3 * triangles[i] + 3; ++h) {
        longest_ = std::max(longest_, length_of(h));
      }
    }
    along_.resize(triangles.size());
    side_.resize(triangles.size());
    node_.resize(triangles.size());
    sprawl_ = sprawl_of(triangles);
  }

  MiddleCut run(double least) {
    MiddleCut best, middle;
    for (int i = 0; i < kDirections; ++i) {
      project(M_PI * i / kDirections);
      for (const double place : kPlaces) {
        MiddleCut cut = try_place(place);
        if (cut.parts.empty()) continue;
        if (cut.fall >= least && cut.fall * best.length >= best.fall * cut.length) best = cut;
        const bool shorter = middle.parts.empty() || cut.length < middle.length;
        if (place == kPlaces[0] && shorter) middle = std::move(cut);
      }
    }
    return best.parts.empty() ? middle : best;
  }

 private:
  double length_of(std::uint32_t h) const {
    const Vec2d &a = chart_.uvs[half_edges_.from(h)], &b = chart_.uvs[half_edges_.to(h)];
    return std::hypot(b.x - a.x, b.y - a.y);
  }

  // Place of the triangle across h in the piece, or kNoIndex.
  std::uint32_t across(std::uint32_t h) const {
    const std::uint32_t o = half_edges_.opposite(h);
    return o == kNoIndex ? kNoIndex : place_[o / 3];
  }

  void project(double angle) {
    const double x = std::cos(angle), y = std::sin(angle);
    for (std::uint32_t i = 0; i < triangles_.size(); ++i) {
      along_[i] = 0;
      for (const std::uint32_t v : chart_.corners[triangles_[i]]) {
        along_[i] += (x * chart_.uvs[v].x + y * chart_.uvs[v].y) / 3;
      }
    }
    const auto [low, high] = std::minmax_element(along_.begin(), along_.end());
    low_ = *low;
    extent_ = *high - *low;
  }

  MiddleCut try_place(double place) {
    MiddleCut cut;
    const double line = low_ + place * extent_, band = kBand * extent_;
    if (!(band > 0)) return cut;
    find_sides(line, band);
    for (int round = 0; round < 2; ++round) {
      cut.parts = parts();
      if (!move_crumbs(cut.parts)) break;
    }
    if (cut.parts.size() < 2) return {};
    for (std::uint32_t i = 0; i < triangles_.size(); ++i) {
      for (std::uint32_t h = 3 * triangles_[i]; h < 3 * triangles_[i] + 3; ++h) {
        const std::uint32_t j = across(h);
        if (j != kNoIndex && i < j && side_[i] != side_[j]) cut.length += length_of(h);
      }
    }
    cut.fall = sprawl_;
    for (const Triangles& part : cut.parts) cut.fall -= sprawl_of(part);
    return cut;
  }

  // Fills side_: 0 below the line.
  void find_sides(double line, double band) {
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
        if (node_[j] == kNoIndex) {
          min_cut_.tie(node_[i], side_[j], MinCut::kForever);
        } else if (i < j) {
          const double off = std::abs((along_[i] + along_[j]) / 2 - line) / band;
          const auto weight = static_cast<std::int32_t>(1 + kUnits * length_of(h) / longest_ *
                                                                (1 + kStray * off * off));
          min_cut_.set_edge({node_[i], k}, {node_[j], half_edges_.opposite(h) % 3}, weight);
        }
      }
    }
    min_cut_.run();
    for (const std::uint32_t i : inside) side_[i] = std::uint8_t(min_cut_.side(node_[i]));
  }

  // Connected triangles of one side each.
  std::vector<Triangles> parts() const {
    std::vector<Triangles> parts;
    std::vector<std::uint8_t> seen(triangles_.size(), 0);
    for (std::uint32_t first = 0; first < triangles_.size(); ++first) {
      if (seen[first]) continue;
      seen[first] = 1;
      Triangles part{first};
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
      parts.push_back(std::move(part));
    }
    return parts;
  }

  // To the other side; whether there were any.
  bool move_crumbs(const std::vector<Triangles>& parts) {
    bool moved = false;
    for (const Triangles& part : parts) {
      double area = 0;
      for (const std::uint32_t t : part) {
        const auto& c = chart_.corners[t];
        area += 0.5 * cross(chart_.uvs[c[0]], chart_.uvs[c[1]], chart_.uvs[c[2]]);
      }
      if (area >= crumb_) continue;
      for (const std::uint32_t t : part) side_[place_[t]] ^= 1;
      moved = true;
    }
    return moved;
  }

  double sprawl_of(std::span<const std::uint32_t> triangles) {
    points_.clear();
    for (const std::uint32_t t : triangles) {
      for (const std::uint32_t v : chart_.corners[t]) points_.push_back(chart_.uvs[v]);
    }
    const double hull = hull_area(points_, hull_);
    return sprawl(hull, box_area(hull_));
  }

  const FlatChart& chart_;
  const param::HalfEdges& half_edges_;
  std::span<const std::uint32_t> triangles_;
  double crumb_, longest_ = 0, sprawl_ = 0, low_ = 0, extent_ = 0;
  std::vector<std::uint32_t> place_;  // 1 a triangle of the chart: its place in triangles_
  // 1 a triangle of the piece: its middle along the direction, its side, its place in the cut.
  std::vector<double> along_;
  std::vector<std::uint8_t> side_;
  std::vector<std::uint32_t> node_;
  MinCut min_cut_;
  std::vector<Vec2d> points_, hull_;
};

}  // namespace

MiddleCut cut_middle(const FlatChart& chart, const param::HalfEdges& half_edges,
                     std::span<const std::uint32_t> triangles, double crumb, double least) {
  return MiddleCutter(chart, half_edges, triangles, crumb).run(least);
}

}  // namespace atlas
