#include "libatlas/pack/outline_mask.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace atlas::pack {
namespace {

struct Bounds {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
  void add(double v) {
    low = std::min(low, v);
    high = std::max(high, v);
  }
};

std::size_t triangle_count(const ChartShape& s) {
  return (s.triangles.empty() ? s.corners.size() : s.triangles.size()) / 3;
}

Vec2d corner(const ChartShape& s, std::size_t k) {
  return s.corners[s.triangles.empty() ? k : s.triangles[k]];
}

// The x range of a triangle within the slab low <= y <= high, which it is known to enter.
Bounds clip_to_slab(const std::array<Vec2d, 3>& t, double low, double high) {
  Bounds x;
  for (int i = 0; i < 3; ++i) {
    const Vec2d a = t[i], b = t[(i + 1) % 3];
    if (a.y >= low && a.y <= high) x.add(a.x);
    for (double level : {low, high})
      if ((a.y < level) != (b.y < level) && a.y != b.y)
        x.add(a.x + (b.x - a.x) * ((level - a.y) / (b.y - a.y)));
  }
  return x;
}

// Collects runs in any order, then sorts them by row and joins them.
class RunSet {
 public:
  struct Item {
    std::int32_t row;
    Run run;
  };
  std::vector<Item> items;

  Mask build() {
    Mask mask;
    if (items.empty()) return mask;
    left_ = items[0].run.begin;
    bottom_ = items[0].row;
    std::int32_t right = items[0].run.end, top = bottom_;
    for (const Item& i : items) {
      left_ = std::min(left_, i.run.begin);
      right = std::max(right, i.run.end);
      bottom_ = std::min(bottom_, i.row);
      top = std::max(top, i.row);
    }
    mask.width = right - left_;
    mask.height = top - bottom_ + 1;
    const std::vector<Run> by_row = sort_by_row(mask);
    join(by_row, mask);
    return mask;
  }
  std::int32_t left() const { return left_; }
  std::int32_t bottom() const { return bottom_; }

 private:
  // Counting sort; mask.first gets the first run of every row.
  std::vector<Run> sort_by_row(Mask& mask) const {
    mask.first.assign(static_cast<std::size_t>(mask.height) + 1, 0);
    for (const Item& i : items) ++mask.first[i.row - bottom_ + 1];
    for (std::int32_t r = 0; r < mask.height; ++r) mask.first[r + 1] += mask.first[r];
    std::vector<std::uint32_t> next(mask.first.begin(), mask.first.end() - 1);
    std::vector<Run> runs(items.size());
    for (const Item& i : items)
      runs[next[i.row - bottom_]++] = {i.run.begin - left_, i.run.end - left_};
    return runs;
  }

  static void join(std::vector<Run> runs, Mask& mask) {
    std::uint32_t from = 0;
    for (std::int32_t r = 0; r < mask.height; ++r) {
      const std::uint32_t to = mask.first[r + 1];
      std::sort(runs.begin() + from, runs.begin() + to,
                [](const Run& a, const Run& b) { return a.begin < b.begin; });
      const std::size_t start = mask.runs.size();
      mask.first[r] = static_cast<std::uint32_t>(start);
      for (; from < to; ++from) {
        if (mask.runs.size() > start && mask.runs.back().end >= runs[from].begin)
          mask.runs.back().end = std::max(mask.runs.back().end, runs[from].end);
        else
          mask.runs.push_back(runs[from]);
      }
    }
    mask.first[mask.height] = static_cast<std::uint32_t>(mask.runs.size());
    for (const Run& run : mask.runs) mask.cells += run.end - run.begin;
  }

  std::int32_t left_ = 0, bottom_ = 0;
};

void add_triangle(const std::array<Vec2d, 3>& t, const RasterOptions& options, RunSet& set) {
  const double pad = options.padding, cell = options.cell;
  Bounds y;
  for (const Vec2d& p : t) y.add(p.y);
  // Rows whose widened open slab (r cell - pad, (r + 1) cell + pad) meets [y.low, y.high].
  const auto row0 = static_cast<std::int32_t>(std::floor((y.low - pad) / cell)) -
                    (std::floor((y.low - pad) / cell) == (y.low - pad) / cell);
  const auto first = row0 + ((row0 + 1) * cell + pad <= y.low);
  auto last = static_cast<std::int32_t>(std::floor((y.high + pad) / cell));
  last -= last * cell - pad >= y.high;
  const bool flat = y.low == y.high;
  for (std::int32_t r = first; r <= last; ++r) {
    const double low = r * cell - pad, high = (r + 1) * cell + pad;
    Bounds x;
    if (flat)
      for (const Vec2d& p : t) x.add(p.x);
    else
      x = clip_to_slab(t, low, high);
    if (x.low > x.high) continue;
    std::int32_t begin = static_cast<std::int32_t>(std::floor((x.low - pad) / cell));
    while ((begin + 1) * cell + pad <= x.low) ++begin;
    std::int32_t end = static_cast<std::int32_t>(std::ceil((x.high + pad) / cell));
    while ((end - 1) * cell - pad >= x.high) --end;
    set.items.push_back({r, {begin, std::max(end, begin + 1)}});
  }
}

}  // namespace

Mask rasterize(const ChartShape& shape, const RasterOptions& options, Vec2d& origin) {
  const double c = options.factor * std::cos(options.angle);
  const double s = options.factor * std::sin(options.angle);
  const auto turn = [&](Vec2d p) { return Vec2d{c * p.x - s * p.y, s * p.x + c * p.y}; };
  const std::size_t triangles = triangle_count(shape);
  origin = {};
  if (triangles == 0) return {};
  Bounds bx, by;
  for (std::size_t k = 0; k < 3 * triangles; ++k) {
    const Vec2d p = turn(corner(shape, k));
    bx.add(p.x);
    by.add(p.y);
  }
  // The chart's lower left corner lies one padding inside its box's, so no cell is wasted there.
  origin = {options.padding - bx.low, options.padding - by.low};
  RunSet set;
  set.items.reserve(4 * triangles);
  for (std::size_t k = 0; k < triangles; ++k) {
    std::array<Vec2d, 3> t;
    for (std::size_t j = 0; j < 3; ++j) {
      const Vec2d p = turn(corner(shape, 3 * k + j));
      t[j] = {p.x + origin.x, p.y + origin.y};
    }
    add_triangle(t, options, set);
  }
  Mask mask = set.build();
  origin.x -= double(set.left()) * options.cell;
  origin.y -= double(set.bottom()) * options.cell;
  return mask;
}

Mask quarter_turn(const Mask& mask) {
  // (x, y) -> (height - 1 - y, x): a row of the result is a column of the input. Where a row
  // differs from the one below it, a run of the column begins or ends; the difference of two rows
  // is given by their run ends, sorted and taken in pairs.
  RunSet set;
  std::vector<std::int32_t> begun(static_cast<std::size_t>(mask.width), -1), ends;
  for (std::int32_t r = 0; r <= mask.height; ++r) {
    ends.clear();
    for (std::int32_t k = std::max(0, r - 1); k <= std::min(r, mask.height - 1); ++k)
      for (const Run& run : mask.row(k)) ends.insert(ends.end(), {run.begin, run.end});
    std::sort(ends.begin(), ends.end());
    for (std::size_t k = 0; k + 1 < ends.size(); k += 2)
      for (std::int32_t x = ends[k]; x < ends[k + 1]; ++x) {
        if (begun[x] >= 0) set.items.push_back({x, {mask.height - r, mask.height - begun[x]}});
        begun[x] = begun[x] >= 0 ? -1 : r;
      }
  }
  return set.build();
}

Mask coarsen(const Mask& mask, std::int32_t factor) {
  RunSet set;
  for (std::int32_t r = 0; r < mask.height; ++r)
    for (const Run& run : mask.row(r))
      set.items.push_back({r / factor, {run.begin / factor, (run.end + factor - 1) / factor}});
  return set.build();
}

double shape_area(const ChartShape& shape) {
  double twice = 0;
  for (std::size_t k = 0; k < triangle_count(shape); ++k) {
    const Vec2d a = corner(shape, 3 * k), b = corner(shape, 3 * k + 1),
                c = corner(shape, 3 * k + 2);
    twice += std::abs((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x));
  }
  return twice / 2;
}

}  // namespace atlas::pack
