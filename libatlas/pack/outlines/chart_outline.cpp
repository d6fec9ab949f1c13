#include "libatlas/pack/outlines/chart_outline.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "libatlas/core/counting_sort.h"
#include "libatlas/core/parallel.h"
#include "libatlas/core/portable_math.h"
#include "libatlas/core/sort_total.h"
#include "libatlas/pack/outlines/covered_area.h"
#include "libatlas/pack/outlines/shape_check.h"

namespace atlas::pack {
namespace {

double twice_area(const Vec2d& a, const Vec2d& b, const Vec2d& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

// Numbers corners that are given three by three. Corners at equal positions get equal numbers.
std::vector<std::uint32_t> weld(std::span<const Vec2d> corners) {
  std::vector<std::uint32_t> order(corners.size()), number(corners.size());
  std::iota(order.begin(), order.end(), 0u);
  sort_total(order.begin(), order.end(), [&](std::uint32_t i, std::uint32_t j) {
    const Vec2d a = corners[i], b = corners[j];
    return a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : i < j;
  });
  for (std::size_t k = 0; k < order.size(); ++k) {
    const bool same = k > 0 && corners[order[k]].x == corners[order[k - 1]].x &&
                      corners[order[k]].y == corners[order[k - 1]].y;
    number[order[k]] = same ? number[order[k - 1]] : order[k];
  }
  return number;
}

// A set of directed edges in which opposite edges cancel. The edges are grouped by their lower
// corner, which few of them share.
class EdgeSum {
 public:
  EdgeSum(std::size_t corners, std::size_t edges) : corners_(corners) { edges_.reserve(edges); }

  void add(std::uint32_t from, std::uint32_t to) {
    if (from == to) return;
    edges_.push_back({std::min(from, to), std::max(from, to), from < to ? 1 : -1});
  }

  // Calls visit(from, to) for every edge that has not been cancelled, in ascending order of its
  // lower and then its higher corner.
  template <class Visit>
  void remaining(Visit visit) {
    std::vector<Half> halves(edges_.size());
    const std::vector<std::uint32_t> first = counting_sort(
        edges_.size(), corners_, [&](std::size_t e) { return edges_[e].low; },
        [&](std::size_t e, std::uint32_t at) {
          halves[at] = {edges_[e].high, edges_[e].sense};
        });
    for (std::uint32_t low = 0; low < corners_; ++low) {
      const auto begin = halves.begin() + first[low], end = halves.begin() + first[low + 1];
      sort_total(begin, end, [](const Half& a, const Half& b) {
        return std::pair(a.high, a.sense) < std::pair(b.high, b.sense);
      });
      for (auto h = begin; h != end;) {
        int sum = 0;
        const std::uint32_t high = h->high;
        for (; h != end && h->high == high; ++h) sum += h->sense;
        for (; sum > 0; --sum) visit(low, high);
        for (; sum < 0; ++sum) visit(high, low);
      }
    }
  }

 private:
  struct Edge {
    std::uint32_t low, high;
    int sense;
  };
  struct Half {
    std::uint32_t high;
    int sense;
  };
  std::size_t corners_;
  std::vector<Edge> edges_;
};

using Link = std::pair<std::uint32_t, std::uint32_t>;  // from, to

// Orders edges such that each begins where the one before it ends, loop after loop.
std::vector<Link> loops_of(std::vector<Link> links) {
  std::sort(links.begin(), links.end());
  std::vector<Link> loops;
  // For each corner, the number of links from it that have been used. It is stored at the first of
  // these links, which are used in order. This stays fast if very many links begin at one corner.
  std::vector<std::uint32_t> taken(links.size());
  const auto take_from = [&](std::uint32_t corner) {
    const auto first =
        std::size_t(std::lower_bound(links.begin(), links.end(), Link{corner, 0}) - links.begin());
    const std::size_t next = first < links.size() ? first + taken[first] : first;
    if (next >= links.size() || links[next].first != corner) return links.size();
    ++taken[first];
    return next;
  };
  std::size_t first = 0;
  for (std::size_t start = 0; start < links.size(); ++start) {
    if (links[start].first != links[first].first) first = start;
    if (start < first + taken[first]) continue;
    for (std::size_t k = take_from(links[start].first); k < links.size();
         k = take_from(links[k].second))
      loops.push_back(links[k]);
  }
  return loops;
}

}  // namespace

ChartOutline outline_of(const ChartShape& shape) {
  ChartOutline outline;
  const std::vector<std::uint32_t> welded =
      shape.triangles.empty() ? weld(shape.corners) : std::vector<std::uint32_t>();
  const std::span<const std::uint32_t> triangles =
      shape.triangles.empty() ? welded : shape.triangles;
  double sum = 0;
  for (std::size_t k = 0; k + 2 < triangles.size(); k += 3)
    sum += twice_area(shape.corners[triangles[k]], shape.corners[triangles[k + 1]],
                      shape.corners[triangles[k + 2]]);
  const bool mirrored = sum < 0;
  EdgeSum edges(shape.corners.size(), triangles.size());
  for (std::size_t k = 0; k + 2 < triangles.size(); k += 3) {
    std::uint32_t a = triangles[k], b = triangles[k + 1], c = triangles[k + 2];
    if (mirrored) std::swap(b, c);
    const double twice = twice_area(shape.corners[a], shape.corners[b], shape.corners[c]);
    outline.area += std::abs(twice) / 2;
    if (twice > 0) {
      edges.add(a, b);
      edges.add(b, c);
      edges.add(c, a);
    } else {
      outline.loose.push_back({shape.corners[a], shape.corners[b], shape.corners[c]});
    }
  }
  std::vector<Link> links;
  edges.remaining([&](std::uint32_t from, std::uint32_t to) { links.emplace_back(from, to); });
  for (const auto& [from, to] : loops_of(std::move(links)))
    outline.edges.push_back({shape.corners[from], shape.corners[to]});
  outline.area *= covered_share(outline);
  return outline;
}

namespace {

struct Bounds2 {
  Vec2d low{1e300, 1e300}, high{-1e300, -1e300};
};

Bounds2 bounds_of(const ChartOutline& outline, double angle) {
  if (outline.empty()) return {{}, {}};
  const double c = portable::cos(angle), s = portable::sin(angle);
  Bounds2 bounds;
  const auto reach = [&](Vec2d p) {
    const Vec2d q{c * p.x - s * p.y, s * p.x + c * p.y};
    bounds.low = {std::min(bounds.low.x, q.x), std::min(bounds.low.y, q.y)};
    bounds.high = {std::max(bounds.high.x, q.x), std::max(bounds.high.y, q.y)};
  };
  // Loops are closed: every end begins an edge.
  for (const ChartOutline::Edge& e : outline.edges) reach(e.from);
  for (const auto& t : outline.loose) std::for_each(t.begin(), t.end(), reach);
  return bounds;
}

}  // namespace

Vec2d box_of(const ChartOutline& outline, double angle) {
  const Bounds2 bounds = bounds_of(outline, angle);
  return {bounds.high.x - bounds.low.x, bounds.high.y - bounds.low.y};
}

Vec2d low_corner_of(const ChartOutline& outline) {
  return bounds_of(outline, 0).low;
}

ChartOutline thinned(const ChartOutline& outline, double spacing) {
  ChartOutline thin;
  thin.loose = outline.loose;
  thin.area = outline.area;
  Vec2d from;
  for (std::size_t k = 0; k < outline.edges.size(); ++k) {
    const auto& e = outline.edges[k];
    const bool starts = k == 0 || !(outline.edges[k - 1].to == e.from);
    const bool ends = k + 1 == outline.edges.size() || !(outline.edges[k + 1].from == e.to);
    if (starts) from = e.from;
    if (!ends && portable::hypot(e.to.x - from.x, e.to.y - from.y) < spacing) continue;
    thin.edges.push_back({from, e.to});
    from = e.to;
  }
  return thin;
}

std::vector<ChartOutline> outlines_of(std::span<const ChartShape> shapes, const Context& context) {
  std::vector<ChartOutline> outlines(shapes.size());
  parallel_for(context, shapes.size(), 4, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) outlines[i] = outline_of(shapes[i]);
  });
  return outlines;
}

}  // namespace atlas::pack

namespace atlas {

Result<double> covered_area(std::span<const ChartShape> shapes, const Context& context) {
  if (Status status = pack::check_shapes(shapes); !status.ok()) return status;
  const std::vector<pack::ChartOutline> outlines = pack::outlines_of(shapes, context);
  if (context.cancelled()) return Status::cancelled();
  double area = 0;
  for (const pack::ChartOutline& outline : outlines) area += outline.area;
  return area;
}

}  // namespace atlas
