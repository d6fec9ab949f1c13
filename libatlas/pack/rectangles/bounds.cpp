#include <algorithm>
#include <span>
#include <utility>
#include <vector>

#include "libatlas/pack/rectangles/engines.h"

namespace atlas::pack {
namespace {

// U(e) of Fekete and Schepers, multiplied by the side: a length above side - e counts as the whole
// side, a length below e as nothing. For e <= side / 2, items that fit along one line never count
// more than one side together.
std::int64_t dual_feasible(std::int64_t length, std::int64_t side, std::int64_t e) {
  if (length > side - e) return side;
  return length < e ? 0 : length;
}

// Returns the thresholds that are worth a try: the lengths up to half a side, thinned out to at
// most 16.
std::vector<std::int64_t> thresholds(std::vector<std::int64_t> lengths, std::int64_t side) {
  std::erase_if(lengths, [&](std::int64_t v) { return 2 * v > side; });
  std::sort(lengths.begin(), lengths.end());
  lengths.erase(std::unique(lengths.begin(), lengths.end()), lengths.end());
  std::vector<std::int64_t> chosen{0};
  constexpr std::size_t most = 16;
  for (std::size_t k = 0; k < std::min(most, lengths.size()); ++k)
    chosen.push_back(lengths[k * lengths.size() / std::min(most, lengths.size())]);
  if (!lengths.empty()) chosen.push_back(lengths.back());
  chosen.push_back(side / 2);
  chosen.erase(std::unique(chosen.begin(), chosen.end()), chosen.end());
  return chosen;
}

// The share of a page side that each item counts for, separately for width and height: one per
// threshold and item. The items are taken as they are or turned. An item that does not fit in this
// direction counts as a whole page.
struct Shares {
  std::vector<double> across, up;

  Shares(const Problem& p, bool turned, std::span<const std::int64_t> across_at,
         std::span<const std::int64_t> up_at) {
    const auto fill = [&](std::span<const std::int64_t> at, bool widths, std::vector<double>& out) {
      const std::int64_t side = widths ? p.page.width : p.page.height;
      out.reserve(at.size() * p.items.size());
      for (const std::int64_t e : at)
        for (Extent item : p.items) {
          if (turned) std::swap(item.width, item.height);
          const bool fits = item.width <= p.page.width && item.height <= p.page.height;
          const std::int64_t length = widths ? item.width : item.height;
          out.push_back(fits ? double(dual_feasible(length, side, e)) / double(side) : 1);
        }
    };
    fill(across_at, true, across);
    fill(up_at, false, up);
  }
};

}  // namespace

std::uint32_t area_bound(const Problem& problem) {
  std::int64_t area = 0;  // exact, because callers pass no more than 2^62 cells
  for (const Extent& e : problem.items) area += e.area();
  return static_cast<std::uint32_t>((area + problem.page.area() - 1) / problem.page.area());
}

std::uint32_t page_bound(const Problem& problem) {
  if (problem.items.empty()) return 0;
  std::vector<std::int64_t> widths, heights;
  for (const Extent& e : problem.items) {
    widths.push_back(e.width);
    heights.push_back(e.height);
    if (problem.allow_rotation) {
      widths.push_back(e.height);
      heights.push_back(e.width);
    }
  }
  // For more than 2000 items the area is nearly as good a bound, except for items that exceed half
  // a side.
  std::vector<std::int64_t> along{0, problem.page.width / 2}, up{0, problem.page.height / 2};
  if (problem.items.size() <= 2000) {
    along = thresholds(std::move(widths), problem.page.width);
    up = thresholds(std::move(heights), problem.page.height);
  }
  const std::size_t n = problem.items.size();
  const Shares upright(problem, false, along, up);
  const Shares turned(problem, problem.allow_rotation, along, up);
  double most = 0;
  for (std::size_t a = 0; a < along.size(); ++a)
    for (std::size_t u = 0; u < up.size(); ++u) {
      const double *w = &upright.across[a * n], *h = &upright.up[u * n];
      const double *turned_w = &turned.across[a * n], *turned_h = &turned.up[u * n];
      double total = 0;
      for (std::size_t i = 0; i < n; ++i) total += std::min(w[i] * h[i], turned_w[i] * turned_h[i]);
      most = std::max(most, total);
    }
  const double slack = 1e-9 * most;  // rounding must never raise the bound
  const auto whole = static_cast<std::uint32_t>(most - slack);
  return std::max(1u, whole + (most - slack > whole));
}

std::int64_t height_bound(const Problem& problem) {
  std::int64_t area_rest = 0, rows = 0, tallest = 0, stacked = 0;
  for (const Extent& e : problem.items) {
    // Counts full rows and remaining cells separately, because the total area may exceed 2^63.
    rows += e.area() / problem.page.width;
    area_rest += e.area() % problem.page.width;
    rows += area_rest / problem.page.width;
    area_rest %= problem.page.width;
    const std::int32_t small = std::min(e.width, e.height);
    tallest = std::max<std::int64_t>(tallest, problem.allow_rotation ? small : e.height);
    // Items wider than half the strip cannot lie beside each other, so their heights add up.
    if (2 * std::int64_t{problem.allow_rotation ? small : e.width} > problem.page.width)
      stacked += problem.allow_rotation ? small : e.height;
  }
  return std::max({rows + (area_rest > 0), tallest, stacked});
}

}  // namespace atlas::pack
