#include "libatlas/unwrap/like/page_grid.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "libatlas/core/no_index.h"

namespace atlas {
namespace {

constexpr std::int32_t kMostCells = 1024;  // along a side

// Returns whether a side of `a` has all of `b` beyond it, by the gap.
bool side_between(const TexelCorners& a, const TexelCorners& b, double gap) {
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec2d p = a[k], q = a[(k + 1) % 3];
    const double x = q.x - p.x, y = q.y - p.y, least = -gap * std::sqrt(x * x + y * y);
    if (std::all_of(b.begin(), b.end(),
                    [&](Vec2d v) { return x * (v.y - p.y) - y * (v.x - p.x) <= least; }))
      return true;
  }
  return false;
}

}  // namespace

double twice_area(const TexelCorners& t) {
  return (t[1].x - t[0].x) * (t[2].y - t[0].y) - (t[1].y - t[0].y) * (t[2].x - t[0].x);
}

PageGrid::PageGrid(std::span<const Extent> pages, std::size_t triangles) {
  const double a_side =
      std::sqrt(double(triangles) / double(std::max<std::size_t>(1, pages.size())));
  for (const Extent& extent : pages) {
    Page page;
    page.cell = std::max(extent.width, extent.height) /
                std::clamp(std::ceil(a_side), 1.0, double(kMostCells));
    page.columns = std::max(1, std::int32_t(std::ceil(extent.width / page.cell)));
    page.rows = std::max(1, std::int32_t(std::ceil(extent.height / page.cell)));
    page.first.assign(std::size_t(page.columns) * std::size_t(page.rows), kNoIndex);
    pages_.push_back(std::move(page));
  }
}

// Calls visit(cell) for the cells within `reach` of a triangle, row by row, until it returns true.
template <class Visit>
bool PageGrid::visit_cells(const Page& page, const TexelCorners& corners, double reach,
                           const Visit& visit) {
  const auto [low, high] = std::minmax({corners[0].y, corners[1].y, corners[2].y});
  const auto row_of = [&](double y) {
    return std::int32_t(std::clamp(std::floor(y / page.cell), 0.0, double(page.rows - 1)));
  };
  const auto column_of = [&](double x) {
    return std::int32_t(std::clamp(std::floor(x / page.cell), 0.0, double(page.columns - 1)));
  };
  for (std::int32_t row = row_of(low - reach); row <= row_of(high + reach); ++row) {
    const double bottom = row * page.cell - reach, top = (row + 1) * page.cell + reach;
    double left = std::numeric_limits<double>::infinity(), right = -left;
    const auto take = [&](double x) {
      left = std::min(left, x);
      right = std::max(right, x);
    };
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec2d a = corners[k], b = corners[(k + 1) % 3];
      // Rows at the page's edges stand for all beyond.
      if ((a.y >= bottom || row == 0) && (a.y <= top || row == page.rows - 1)) take(a.x);
      for (const double y : {bottom, top}) {
        if ((a.y < y) != (b.y < y)) take(a.x + (b.x - a.x) * ((y - a.y) / (b.y - a.y)));
      }
    }
    if (!(left <= right)) continue;
    for (std::int32_t x = column_of(left - reach); x <= column_of(right + reach); ++x) {
      if (visit(std::size_t(row) * std::size_t(page.columns) + std::size_t(x))) return true;
    }
  }
  return false;
}

std::uint32_t PageGrid::add(const Place& place, std::uint32_t owner) {
  const auto number = std::uint32_t(entries_.size());
  entries_.push_back({place.corners, owner, true});
  Page& page = pages_[place.page];
  visit_cells(page, place.corners, 0, [&](std::size_t cell) {
    nodes_.push_back({number, page.first[cell]});
    page.first[cell] = std::uint32_t(nodes_.size() - 1);
    return false;
  });
  return number;
}

bool PageGrid::meets(const Place& place, const std::function<double(std::uint32_t owner)>& gap,
                     double most_gap) const {
  const Page& page = pages_[place.page];
  return visit_cells(page, place.corners, std::max(0.0, most_gap), [&](std::size_t cell) {
    for (std::uint32_t n = page.first[cell]; n != kNoIndex; n = nodes_[n].next) {
      const Entry& other = entries_[nodes_[n].entry];
      if (!other.alive) continue;
      const double apart = gap(other.owner);
      if (!side_between(place.corners, other.corners, apart) &&
          !side_between(other.corners, place.corners, apart))
        return true;
    }
    return false;
  });
}

}  // namespace atlas
