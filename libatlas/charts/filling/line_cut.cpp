#include "libatlas/charts/filling/line_cut.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "libatlas/core/hull.h"
#include "libatlas/core/portable_math.h"

namespace atlas {
namespace {

// An edge at the end of the band counts as longer by this share.
constexpr double kStray = 0.5;
// Weights are integers: the longest edge has this one.
constexpr double kUnits = 1 << 14;
// The most triangles in the graph of a minimum cut. Where a band holds more, it is narrowed to as
// many around that line in it that crosses the least edge length. Without this, minimum cuts
// through a lattice of 839 250 triangles took a minute.
constexpr std::size_t kMostInside = 4000;
constexpr std::size_t kLines = 128;  // candidates for that line

}  // namespace

LineCutter::LineCutter(const FlatChart& chart, const param::HalfEdges& half_edges,
                       std::span<const std::uint32_t> triangles,
                       std::span<const std::uint32_t> polygons)
    : chart_(chart),
      triangles_(triangles),
      joined_(3 * triangles.size()),
      length_(3 * triangles.size()),
      along_(triangles.size()),
      side_(triangles.size()),
      node_(triangles.size()) {
  std::vector<std::uint32_t> place(chart.triangles.size(), kNoIndex);
  for (std::uint32_t i = 0; i < triangles.size(); ++i) place[triangles[i]] = i;
  for (std::uint32_t s = 0; s < joined_.size(); ++s) {
    const std::uint32_t h = 3 * triangles[s / 3] + s % 3, o = half_edges.opposite(h);
    const bool inside = o != kNoIndex && place[o / 3] != kNoIndex;
    joined_[s] = inside ? 3 * place[o / 3] + o % 3 : kNoIndex;
    const Vec2d &a = chart.uvs[half_edges.from(h)], &b = chart.uvs[half_edges.to(h)];
    length_[s] = static_cast<float>(portable::hypot(b.x - a.x, b.y - a.y));
    longest_ = std::max<double>(longest_, length_[s]);
  }
  number_polygons(polygons);
  face(0);
}

void LineCutter::number_polygons(std::span<const std::uint32_t> polygons) {
  if (polygons.empty()) return;
  std::vector<std::uint32_t> numbers;
  for (const std::uint32_t i : triangles_) numbers.push_back(polygons[chart_.triangles[i]]);
  polygon_ = numbers;
  std::sort(numbers.begin(), numbers.end());
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
  for (std::uint32_t& p : polygon_)
    p = std::uint32_t(std::lower_bound(numbers.begin(), numbers.end(), p) - numbers.begin());
  polygon_count_ = std::uint32_t(numbers.size());
}

// Puts the triangles of each polygon where their mean is.
void LineCutter::gather_polygons() {
  std::vector<double> sum(polygon_count_, 0), count(polygon_count_, 0);
  for (std::uint32_t i = 0; i < polygon_.size(); ++i) {
    sum[polygon_[i]] += along_[i];
    ++count[polygon_[i]];
  }
  for (std::uint32_t i = 0; i < polygon_.size(); ++i)
    along_[i] = sum[polygon_[i]] / count[polygon_[i]];
}

void LineCutter::face(double angle) {
  const double x = portable::cos(angle), y = portable::sin(angle);
  for (std::uint32_t i = 0; i < triangles_.size(); ++i) {
    along_[i] = 0;
    for (const std::uint32_t v : chart_.corners[triangles_[i]]) {
      along_[i] += (x * chart_.uvs[v].x + y * chart_.uvs[v].y) / 3;
    }
  }
  gather_polygons();
  const auto [low, high] = std::minmax_element(along_.begin(), along_.end());
  low_ = *low;
  high_ = *high;
}

LineCut LineCutter::cut(double line, double band, double crumb) {
  LineCut cut;
  if (!(band > 0)) return cut;
  narrow(line, band);
  find_sides(line, band);
  cut.parts = parts();
  if (move_crumbs(cut.parts, crumb)) cut.parts = parts();
  if (cut.parts.size() < 2) return {};
  for (LineCut::Part& part : cut.parts) {
    for (std::uint32_t& i : part.triangles) i = triangles_[i];
  }
  for (std::uint32_t s = 0; s < joined_.size(); ++s) {
    const std::uint32_t o = joined_[s];
    if (o != kNoIndex && s < o && side_[s / 3] != side_[o / 3]) cut.length += length_[s];
  }
  return cut;
}

void LineCutter::narrow(double& line, double& band) const {
  std::vector<double> away(triangles_.size());
  for (std::size_t i = 0; i < away.size(); ++i) away[i] = std::abs(along_[i] - line);
  const auto inside = std::count_if(away.begin(), away.end(), [&](double d) { return d < band; });
  if (std::size_t(inside) <= kMostInside) return;
  // Each edge counts for all lines between the centroids of its two triangles.
  const double first = line - band, step = 2 * band / double(kLines - 1);
  const auto next_line = [&](double at) {
    return std::size_t(std::clamp(std::ceil((at - first) / step), 0.0, double(kLines)));
  };
  std::vector<double> rise(kLines + 1, 0);
  for (std::uint32_t s = 0; s < joined_.size(); ++s) {
    if (joined_[s] == kNoIndex) continue;
    const double from = along_[s / 3], to = along_[joined_[s] / 3];
    if (to <= from) continue;
    rise[next_line(from)] += length_[s];
    rise[next_line(to)] -= length_[s];
  }
  double crossed = 0, least = std::numeric_limits<double>::infinity(), best = line;
  for (std::size_t k = 0; k < kLines; ++k) {
    crossed += rise[k];
    const double at = first + double(k) * step, off = (at - line) / band;
    if (crossed * (1 + kStray * off * off) >= least) continue;
    least = crossed * (1 + kStray * off * off);
    best = at;
  }
  line = best;
  for (std::size_t i = 0; i < away.size(); ++i) away[i] = std::abs(along_[i] - line);
  std::nth_element(away.begin(), away.begin() + kMostInside, away.end());
  band = away[kMostInside];
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
      const std::uint32_t s = 3 * i + k, o = joined_[s];
      if (o == kNoIndex) continue;
      const std::uint32_t j = o / 3;
      const double off = std::min(1.0, std::abs((along_[i] + along_[j]) / 2 - line) / band);
      const double share = length_[s] / longest_ * (1 + kStray * off * off);
      const std::int32_t weight =
          together(i, j) ? MinCut::kForever : static_cast<std::int32_t>(1 + kUnits * share);
      if (node_[j] == kNoIndex) {
        min_cut_.tie(node_[i], side_[j], weight);
      } else if (i < j) {
        min_cut_.set_edge({node_[i], k}, {node_[j], o % 3}, weight);
      }
    }
  }
  min_cut_.run();
  for (const std::uint32_t i : inside) side_[i] = std::uint8_t(min_cut_.side(node_[i]));
}

// Returns the connected parts of both sides.
std::vector<LineCut::Part> LineCutter::parts() const {
  std::vector<LineCut::Part> parts;
  std::vector<std::uint32_t> part_of(triangles_.size(), kNoIndex), queue;
  for (std::uint32_t first = 0; first < triangles_.size(); ++first) {
    if (part_of[first] == kNoIndex) {
      const auto part = std::uint32_t(parts.size());
      parts.push_back({{}, side_[first] != 0});
      part_of[first] = part;
      queue.assign(1, first);
      while (!queue.empty()) {
        const std::uint32_t i = queue.back();
        queue.pop_back();
        for (std::uint32_t s = 3 * i; s < 3 * i + 3; ++s) {
          const std::uint32_t j = joined_[s] == kNoIndex ? i : joined_[s] / 3;
          if (part_of[j] != kNoIndex || side_[i] != side_[j]) continue;
          part_of[j] = part;
          queue.push_back(j);
        }
      }
    }
    parts[part_of[first]].triangles.push_back(first);
  }
  return parts;
}

// Moves parts smaller than `crumb` to the other side. Returns whether there were any.
bool LineCutter::move_crumbs(const std::vector<LineCut::Part>& parts, double crumb) {
  bool moved = false;
  for (const LineCut::Part& part : parts) {
    double area = 0;
    for (const std::uint32_t i : part.triangles) {
      const auto& c = chart_.corners[triangles_[i]];
      area += 0.5 * cross(chart_.uvs[c[0]], chart_.uvs[c[1]], chart_.uvs[c[2]]);
    }
    if (area >= crumb) continue;
    for (const std::uint32_t i : part.triangles) side_[i] ^= 1;
    moved = true;
  }
  return moved;
}

}  // namespace atlas
