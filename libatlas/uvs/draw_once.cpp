#include "libatlas/uvs/draw_once.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numeric>
#include <optional>
#include <tuple>
#include <utility>

#include "libatlas/charts/chart_triangles.h"
#include "libatlas/core/bounds.h"
#include "libatlas/core/glm_bridge.h"
#include "libatlas/core/parallel.h"
#include "libatlas/pack/outlines/chart_outline.h"
#include "libatlas/uvs/chart_drawing.h"

namespace atlas {
namespace {

constexpr int kFarthest = kDrawnSteps / 4;  // along each axis, in steps
// How many places are checked for neighbours, and how many of these are drawn.
constexpr std::size_t kPlaces = 256, kDrawings = 16;

// How far lookups and a move reach beyond a chart at most, in texels, once this is rounded outwards
// to whole texels. Lookups read texels whose centres are less than a texel away, and a move takes
// them at most a quarter of a texel further.
constexpr double kReach = 1;

using Box = Bounds<glm::dvec2>;

// Sorts the boxes of charts by the squares of their pages that they reach into.
class BoxBuckets {
 public:
  BoxBuckets(const PlacedCharts& placed, const std::vector<Box>& boxes)
      : placed_(placed), boxes_(boxes), seen_(boxes.size(), 0) {
    first_.push_back(0);
    for (const Extent& page : placed.pages) {
      const glm::ivec2 count = squares(page);
      first_.push_back(first_.back() + std::size_t(count.x) * std::size_t(count.y));
    }
    charts_.resize(first_.back());
    for (std::uint32_t c = 0; c < boxes.size(); ++c)
      each_square(c, [&](std::size_t square) { charts_[square].push_back(c); });
  }

  // Returns the other charts of c's page whose boxes may be within twice kReach of c's box along
  // both axes: those that share a square with c when the boxes are enlarged.
  std::vector<std::uint32_t> near(std::size_t c) {
    std::vector<std::uint32_t> found;
    ++searches_;
    seen_[c] = searches_;
    each_square(c, [&](std::size_t square) {
      for (const std::uint32_t other : charts_[square]) {
        if (std::exchange(seen_[other], searches_) != searches_) found.push_back(other);
      }
    });
    return found;
  }

 private:
  // Returns the side of a square in texels. A page has at most 64 squares along a side, because the
  // boxes of slanted strips reach into most of them.
  static int side(const Extent& page) {
    return std::max(64, (std::max(page.width, page.height) + 63) / 64);
  }
  static glm::ivec2 squares(const Extent& page) {
    return (glm::ivec2(page.width, page.height) + side(page) - 1) / side(page);
  }

  template <class Visit>
  void each_square(std::size_t c, const Visit& visit) const {
    if (!(boxes_[c].low.x <= boxes_[c].high.x)) return;  // a chart without uvs
    const auto p = std::size_t(placed_.placements[c].page);
    const glm::ivec2 count = squares(placed_.pages[p]);
    const auto square = [&](glm::dvec2 at) {
      const glm::dvec2 place = glm::floor(at / double(side(placed_.pages[p])));
      return glm::clamp(glm::ivec2(place), glm::ivec2(0), count - 1);
    };
    const glm::ivec2 low = square(boxes_[c].low - kReach - 1.0),
                     high = square(boxes_[c].high + kReach + 1.0);
    for (int y = low.y; y <= high.y; ++y) {
      for (int x = low.x; x <= high.x; ++x)
        visit(first_[p] + std::size_t(y) * std::size_t(count.x) + std::size_t(x));
    }
  }

  const PlacedCharts& placed_;
  const std::vector<Box>& boxes_;
  std::vector<std::size_t> first_;  // one per page: its first square
  std::vector<std::vector<std::uint32_t>> charts_;
  std::vector<std::uint32_t> seen_;  // one per chart: the last search that found it
  std::uint32_t searches_ = 0;
};

// Calls texel(x, y) for each texel that bilinear lookups along a segment read. Those are the four
// texels around each square between texel centres that the segment meets.
template <class Texel>
void lookups_along(glm::dvec2 a, glm::dvec2 b, Texel&& texel) {
  a -= 0.5;
  b -= 0.5;
  if (a.y > b.y) std::swap(a, b);
  const glm::dvec2 d = b - a;
  const auto x_at = [&](double y) {
    return d.y > 0 ? a.x + d.x * std::clamp((y - a.y) / d.y, 0.0, 1.0) : a.x;
  };
  for (int y = int(std::floor(a.y)); y <= int(std::floor(b.y)); ++y) {
    const double x0 = x_at(y), x1 = d.y > 0 ? x_at(y + 1.0) : b.x;
    const int last = int(std::floor(std::max(x0, x1))) + 1;
    for (int x = int(std::floor(std::min(x0, x1))); x <= last; ++x) {
      texel(x, y);
      texel(x, y + 1);
    }
  }
}

template <class Texel>
void lookups_of(const pack::ChartOutline& outline, glm::dvec2 shift, Texel&& texel) {
  for (const pack::ChartOutline::Edge& e : outline.edges)
    lookups_along(to_glm(e.from) + shift, to_glm(e.to) + shift, texel);
  for (const auto& t : outline.loose) {
    for (int k = 0; k < 3; ++k)
      lookups_along(to_glm(t[k]) + shift, to_glm(t[(k + 1) % 3]) + shift, texel);
  }
}

// The charts of all pages as graphics hardware draws them.
class Drawings {
 public:
  Drawings(const PlacedCharts& placed, std::span<const std::uint32_t> corners,
           std::span<const Vec2f> uvs)
      : placed_(placed), corners_(corners), uvs_(uvs) {}

  // Returns, for each chart, how many texels are drawn twice.
  std::vector<std::size_t> count(const Context& context) const {
    const std::size_t n = placed_.charts.charts.size();
    std::vector<std::size_t> twice(n, 0);
    parallel_for(context, n, 16, [&](std::size_t begin, std::size_t end) {
      for (std::size_t c = begin; c < end; ++c) twice[c] = drawing(c).texels_drawn_twice({0, 0});
    });
    return twice;
  }

 protected:
  const Chart& chart(std::size_t c) const { return placed_.charts.charts[c]; }
  glm::dvec2 page_of(std::size_t c) const {
    const Extent page = placed_.pages[std::size_t(placed_.placements[c].page)];
    return {page.width, page.height};
  }

  std::vector<std::uint32_t> corners_of(std::size_t c) const {
    std::vector<std::uint32_t> corners;
    corners.reserve(3 * std::size_t(chart(c).triangle_count));
    for (const std::size_t t : triangles_of(placed_.charts, chart(c))) {
      for (const std::uint32_t corner :
           from_lowest({corners_[3 * t], corners_[3 * t + 1], corners_[3 * t + 2]}))
        corners.push_back(corner);
    }
    return corners;
  }

  ChartDrawing drawing(std::size_t c) const {
    return {corners_of(c), {chart(c).first_uv, chart(c).uv_count}, uvs_, page_of(c)};
  }

  const PlacedCharts& placed_;
  std::span<const std::uint32_t> corners_;
  std::span<const Vec2f> uvs_;
};

class Mover : private Drawings {
 public:
  Mover(const PlacedCharts& placed, std::span<const std::uint32_t> corners, std::vector<Vec2f>& uvs)
      : Drawings(placed, corners, uvs), moving_uvs_(uvs) {}

  DrawnTwice run(const Context& context) {
    const std::vector<std::size_t> twice = count(context);
    DrawnTwice drawn;
    for (std::size_t c = 0; c < twice.size() && !context.cancelled(); ++c) {
      if (twice[c] == 0) continue;
      drawn.before += twice[c];
      if (placed_.stays(c)) {
        drawn.after += twice[c];
        continue;
      }
      if (boxes_.empty()) find_boxes();
      const Place best = best_place(c, twice[c]);
      drawn.after += best.texels;
      if (best.steps == glm::ivec2(0)) continue;
      drawn.moves.push_back({std::uint32_t(c), from_glm(glm::dvec2(best.steps) / kSteps)});
      ChartDrawing draw = drawing(c);
      const std::span<const Vec2f> moved = draw.moved(best.steps);
      std::copy(moved.begin(), moved.end(), moving_uvs_.begin() + chart(c).first_uv);
      outlines_[c].reset();
    }
    return drawn;
  }

 private:
  static constexpr double kSteps = kDrawnSteps;
  struct Place {
    glm::ivec2 steps{0};
    std::size_t texels = 0;  // drawn twice
  };
  // One byte per texel of a chart's box and its surroundings: whether lookups of other charts read
  // it.
  struct Taken {
    Rect box;
    std::vector<std::uint8_t> texels;

    std::uint8_t* at(int x, int y) {
      if (x < box.x || x >= box.right() || y < box.y || y >= box.top()) return nullptr;
      return &texels[std::size_t(y - box.y) * std::size_t(box.width) + std::size_t(x - box.x)];
    }
  };

  // Returns the outline of a chart on its page, in texels. It is kept until the chart is moved,
  // because many charts may have this one as their neighbour.
  const pack::ChartOutline& outline(std::size_t c) {
    if (outlines_[c]) return *outlines_[c];
    std::vector<Vec2d> texels;
    for (std::uint32_t i = 0; i < chart(c).uv_count; ++i)
      texels.push_back(from_glm(to_dvec(uvs_[chart(c).first_uv + i]) * page_of(c)));
    std::vector<std::uint32_t> corners = corners_of(c);
    for (std::uint32_t& corner : corners) corner -= chart(c).first_uv;
    return outlines_[c].emplace(pack::outline_of({texels, corners}));
  }

  void find_boxes() {
    for (std::size_t c = 0; c < placed_.charts.charts.size(); ++c) {
      Box& box = boxes_.emplace_back();
      for (std::uint32_t i = 0; i < chart(c).uv_count; ++i)
        box.add(to_dvec(uvs_[chart(c).first_uv + i]) * page_of(c));
    }
    outlines_.resize(boxes_.size());
    buckets_.emplace(placed_, boxes_);
  }

  Taken taken_around(std::size_t c) {
    const glm::dvec2 low = glm::floor(boxes_[c].low - kReach),
                     high = glm::ceil(boxes_[c].high + kReach);
    Taken taken;
    taken.box = {int(low.x), int(low.y), int(high.x - low.x), int(high.y - low.y)};
    taken.texels.assign(std::size_t(taken.box.area()), 0);
    for (const std::uint32_t other : buckets_->near(c)) {
      if (glm::any(glm::lessThan(boxes_[other].high + kReach, low)) ||
          glm::any(glm::greaterThan(boxes_[other].low - kReach, high)))
        continue;
      lookups_of(outline(other), {}, [&](int x, int y) {
        if (std::uint8_t* texel = taken.at(x, y)) *texel = 1;
      });
    }
    return taken;
  }

  bool within_page(std::size_t c, glm::dvec2 shift) const {
    const Box& box = boxes_[c];
    const glm::dvec2 low = glm::min(box.low, glm::dvec2(1)),
                     high = glm::max(box.high, page_of(c) - 1.0);
    return glm::all(glm::greaterThanEqual(box.low + shift, low)) &&
           glm::all(glm::lessThanEqual(box.high + shift, high));
  }

  // Returns the places with the fewest hits first, and among these the nearest first.
  static std::vector<glm::ivec2> places(std::span<const std::uint32_t> hits) {
    using Key = std::tuple<std::uint32_t, int, int, int>;
    std::vector<Key> keys;
    for (int y = -kFarthest; y <= kFarthest; ++y) {
      for (int x = -kFarthest; x <= kFarthest; ++x) {
        const int column = (x + kDrawnSteps) % kDrawnSteps, row = (y + kDrawnSteps) % kDrawnSteps;
        if (x != 0 || y != 0)
          keys.emplace_back(hits[std::size_t(row) * kDrawnSteps + std::size_t(column)],
                            x * x + y * y, x, y);
      }
    }
    std::partial_sort(keys.begin(), keys.begin() + kPlaces, keys.end());
    std::vector<glm::ivec2> sorted;
    for (std::size_t i = 0; i < kPlaces; ++i)
      sorted.emplace_back(std::get<2>(keys[i]), std::get<3>(keys[i]));
    return sorted;
  }

  Place best_place(std::size_t c, std::size_t texels) {
    ChartDrawing draw = drawing(c);
    const std::size_t thin = draw.thin_triangles({0, 0});
    Taken taken = taken_around(c);
    const pack::ChartOutline& border = outline(c);
    Place best{{0, 0}, texels};
    std::size_t drawings = 0;
    for (const glm::ivec2 steps : places(draw.hits_of_turned())) {
      const glm::dvec2 shift = glm::dvec2(steps) / kSteps;
      if (!within_page(c, shift)) continue;
      bool meets = false;
      lookups_of(border, shift, [&](int x, int y) {
        const std::uint8_t* texel = taken.at(x, y);
        meets = meets || (texel && *texel);
      });
      if (meets || draw.thin_triangles(steps) > thin) continue;
      const std::size_t left = draw.texels_drawn_twice(steps);
      if (left < best.texels) best = {steps, left};
      if (best.texels == 0 || ++drawings == kDrawings) break;
    }
    return best;
  }

  std::vector<Vec2f>& moving_uvs_;
  // Filled once a chart is to be moved. There is one box and one outline per chart, in texels.
  std::vector<Box> boxes_;
  std::vector<std::optional<pack::ChartOutline>> outlines_;
  std::optional<BoxBuckets> buckets_;
};

}  // namespace

DrawnTwice draw_once(const PlacedCharts& placed, std::span<const std::uint32_t> corners,
                     std::vector<Vec2f>& uvs, const Context& context) {
  return Mover(placed, corners, uvs).run(context);
}

DrawnTwice drawn_twice(const PlacedCharts& placed, std::span<const std::uint32_t> corners,
                       std::span<const Vec2f> uvs, const Context& context) {
  const std::vector<std::size_t> twice = Drawings(placed, corners, uvs).count(context);
  DrawnTwice drawn;
  drawn.before = drawn.after = std::accumulate(twice.begin(), twice.end(), std::size_t{0});
  return drawn;
}

}  // namespace atlas
