#include "libatlas/pack/outlines/covered_area.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "libatlas/core/sort_total.h"

namespace atlas::pack {
namespace {

// Measures the lengths of the chart on lines y = constant.
class Lines {
 public:
  Lines(const ChartOutline& outline, int count) : count_(count) {
    low_ = 1e300;
    double high = -1e300;
    const auto reach = [&](Vec2d p) {
      low_ = std::min(low_, p.y);
      high = std::max(high, p.y);
    };
    for (const ChartOutline::Edge& e : outline.edges) reach(e.from);
    for (const auto& t : outline.loose) std::for_each(t.begin(), t.end(), reach);
    spacing_ = (high - low_) / count;
    if (!(spacing_ > 0)) return;
    for (const ChartOutline::Edge& e : outline.edges) cross(e.from, e.to);
    for (const auto& [a, b, c] : outline.loose) {
      const double twice = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
      const bool turned = twice < 0;
      cross(a, turned ? c : b);
      cross(turned ? c : b, turned ? b : c);
      cross(turned ? b : c, a);
    }
    sweep();
  }

  double share() const { return all_ > 0 ? covered_ / all_ : 1; }

 private:
  struct Crossing {
    int line;
    double x;
    int change;  // change in the number of triangles to the right of the crossing
  };

  // The chart lies to the left of the edge, so it lies to the right of an edge that goes down.
  void cross(Vec2d from, Vec2d to) {
    const int change = to.y < from.y ? 1 : -1;
    if (change > 0) std::swap(from, to);
    if (!(to.y > from.y)) return;
    const auto line_above = [&](double y) {  // the first line that is not below y
      return int(std::clamp(std::ceil((y - low_) / spacing_ - 0.5), 0.0, double(count_)));
    };
    const int end = line_above(to.y);
    for (int line = line_above(from.y); line < end; ++line) {
      const double t = (low_ + (line + 0.5) * spacing_ - from.y) / (to.y - from.y);
      crossings_.push_back({line, from.x + t * (to.x - from.x), change});
    }
  }

  void sweep() {
    sort_total(crossings_.begin(), crossings_.end(), [](const Crossing& a, const Crossing& b) {
      return std::tie(a.line, a.x, a.change) < std::tie(b.line, b.x, b.change);
    });
    int depth = 0;
    for (std::size_t k = 0; k + 1 < crossings_.size(); ++k) {
      const Crossing &at = crossings_[k], &next = crossings_[k + 1];
      depth = k > 0 && crossings_[k - 1].line != at.line ? at.change : depth + at.change;
      if (depth <= 0 || next.line != at.line) continue;
      all_ += depth * (next.x - at.x);
      covered_ += next.x - at.x;
    }
  }

  int count_;
  double low_ = 0, spacing_ = 0, all_ = 0, covered_ = 0;
  std::vector<Crossing> crossings_;
};

}  // namespace

double covered_share(const ChartOutline& outline) {
  constexpr int kFew = 16, kMany = 512;
  constexpr double kRounding = 1e-6;
  if (Lines(outline, kFew).share() > 1 - kRounding) return 1;
  return Lines(outline, kMany).share();
}

}  // namespace atlas::pack
