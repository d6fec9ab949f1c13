#include "libatlas/pack/outline_mask.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "libatlas/core/counting_sort.h"

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

  // Rows 0 .. rows - 1 are those that add() may know.
  explicit RunSet(std::int32_t rows = 0) : last_(static_cast<std::size_t>(rows), kNone) {}

  // A run that touches the one before it in its row, as those of edges that follow each other
  // mostly do, makes that one longer: teeth finer than cells would else take gigabytes.
  void add(std::int32_t row, Run run) {
    if (static_cast<std::size_t>(row) < last_.size()) {
      std::uint32_t& last = last_[static_cast<std::size_t>(row)];
      if (last != kNone) {
        Run& before = items[last].run;
        if (run.begin <= before.end && before.begin <= run.end) {
          before = {std::min(before.begin, run.begin), std::max(before.end, run.end)};
          return;
        }
      }
      last = static_cast<std::uint32_t>(items.size());
    }
    items.push_back({row, run});
  }

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
  // mask.first gets the first run of every row.
  std::vector<Run> sort_by_row(Mask& mask) const {
    std::vector<Run> runs(items.size());
    mask.first = counting_sort(
        items.size(), static_cast<std::size_t>(mask.height),
        [&](std::size_t i) { return static_cast<std::size_t>(items[i].row - bottom_); },
        [&](std::size_t i, std::uint32_t at) {
          runs[at] = {items[i].run.begin - left_, items[i].run.end - left_};
        });
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

  static constexpr std::uint32_t kNone = 0xffffffffu;
  std::vector<std::uint32_t> last_;  // 1 a row: the item added last
  std::int32_t left_ = 0, bottom_ = 0;
};

// Rows [first, last] whose widened open slab (r cell - pad, (r + 1) cell + pad) meets [low, high].
struct Rows {
  std::int32_t first, last;
  Rows(const Bounds& y, double pad, double cell) {
    const double below = std::floor((y.low - pad) / cell);
    const auto row0 = static_cast<std::int32_t>(below) - (below == (y.low - pad) / cell);
    first = row0 + ((row0 + 1) * cell + pad <= y.low);
    last = static_cast<std::int32_t>(std::floor((y.high + pad) / cell));
    last -= last * cell - pad >= y.high;
  }
};

// The cells of a row whose widened open interval meets [x.low, x.high].
Run cells_within(const Bounds& x, double pad, double cell) {
  std::int32_t begin = static_cast<std::int32_t>(std::floor((x.low - pad) / cell));
  while ((begin + 1) * cell + pad <= x.low) ++begin;
  std::int32_t end = static_cast<std::int32_t>(std::ceil((x.high + pad) / cell));
  while ((end - 1) * cell - pad >= x.high) --end;
  return {begin, std::max(end, begin + 1)};
}

void add_triangle(const std::array<Vec2d, 3>& t, const RasterOptions& options, RunSet& set) {
  const double pad = options.padding, cell = options.cell;
  Bounds y;
  for (const Vec2d& p : t) y.add(p.y);
  const Rows rows(y, pad, cell);
  for (std::int32_t r = rows.first; r <= rows.last; ++r) {
    Bounds x;
    if (y.low == y.high)
      for (const Vec2d& p : t) x.add(p.x);
    else
      x = clip_to_slab(t, r * cell - pad, (r + 1) * cell + pad);
    if (x.low <= x.high) set.add(r, cells_within(x, pad, cell));
  }
}

void add_edge(Vec2d a, Vec2d b, const RasterOptions& options, RunSet& set) {
  const double pad = options.padding, cell = options.cell;
  if (a.y > b.y) std::swap(a, b);
  Bounds y;
  y.add(a.y);
  y.add(b.y);
  const Rows rows(y, pad, cell);
  const double slope = a.y < b.y ? (b.x - a.x) / (b.y - a.y) : 0;
  for (std::int32_t r = rows.first; r <= rows.last; ++r) {
    const double low = r * cell - pad, high = (r + 1) * cell + pad;
    Bounds x;
    x.add(a.y >= low ? a.x : a.x + slope * (low - a.y));
    x.add(b.y <= high ? b.x : a.x + slope * (high - a.y));
    if (a.y == b.y) x.add(a.x);
    set.add(r, cells_within(x, pad, cell));
  }
}

// Cells whose centres the edges wind around. What lies nearer to an edge than that is add_edge's.
class Interior {
 public:
  // `cells`: the rows and columns that edges may cross.
  Interior(std::int32_t cell, Extent cells)
      : cell_(cell),
        cells_(cells),
        most_crossings_(std::max(kManyCrossings, std::size_t(cells.area()) / 4)) {}

  void add(Vec2d a, Vec2d b) {
    const std::int32_t sense = a.y < b.y ? 1 : -1;
    if (sense < 0) std::swap(a, b);
    // Rows whose middle lies in [a.y, b.y).
    const auto first = static_cast<std::int32_t>(std::ceil(a.y / cell_ - 0.5));
    const auto end = static_cast<std::int32_t>(std::ceil(b.y / cell_ - 0.5));
    if (first >= end) return;
    const double slope = (b.x - a.x) / (b.y - a.y);
    for (std::int32_t r = first; r < end; ++r)
      crossings_.push_back({r, sense, a.x + slope * ((r + 0.5) * cell_ - a.y)});
    if (crossings_.size() > most_crossings_) count();
  }

  void fill(RunSet& set) {
    if (!turns_.empty()) {
      count();
      return fill_counted(set);
    }
    sort();
    std::int32_t winding = 0;
    for (std::size_t k = 0; k + 1 < crossings_.size(); ++k) {
      const Crossing &c = crossings_[k], &next = crossings_[k + 1];
      winding = (k > 0 && crossings_[k - 1].row == c.row ? winding : 0) + c.sense;
      if (winding == 0 || next.row != c.row) continue;
      const std::int32_t begin = first_beyond(c.x);
      const auto end = static_cast<std::int32_t>(std::floor(next.x / cell_ - 0.5)) + 1;
      if (begin < end) set.add(c.row, {begin, end});
    }
  }

 private:
  struct Crossing {
    std::int32_t row, sense;
    double x;
  };
  static constexpr std::size_t kManyCrossings = 1 << 21;  // 32 MiB

  // The first cell whose centre is not left of x.
  std::int32_t first_beyond(double x) const {
    return static_cast<std::int32_t>(std::ceil(x / cell_ - 0.5));
  }

  // Crossings that would take more memory than cells are counted by those at which they begin to
  // matter.
  void count() {
    const auto w = static_cast<std::size_t>(cells_.width) + 1;
    turns_.resize(w * static_cast<std::size_t>(cells_.height));
    for (const Crossing& c : crossings_) {
      const std::int32_t row = std::clamp(c.row, 0, cells_.height - 1);
      const std::int32_t x = std::clamp(first_beyond(c.x), 0, cells_.width);
      turns_[static_cast<std::size_t>(row) * w + static_cast<std::size_t>(x)] += c.sense;
    }
    crossings_.clear();
  }

  void fill_counted(RunSet& set) const {
    const std::int32_t* turn = turns_.data();
    for (std::int32_t r = 0; r < cells_.height; ++r) {
      std::int32_t winding = 0;
      for (std::int32_t x = 0; x <= cells_.width; ++x, ++turn) {
        winding += *turn;
        if (winding != 0) set.add(r, {x, x + 1});
      }
    }
  }

  // By row, in time linear in crossings and rows, then the few of each row by x.
  void sort() {
    if (crossings_.empty()) return;
    std::int32_t low = crossings_[0].row, high = low;
    for (const Crossing& c : crossings_) {
      low = std::min(low, c.row);
      high = std::max(high, c.row);
    }
    std::vector<Crossing> sorted(crossings_.size());
    const std::vector<std::uint32_t> first = counting_sort(
        crossings_.size(), static_cast<std::size_t>(high - low) + 1,
        [&](std::size_t i) { return static_cast<std::size_t>(crossings_[i].row - low); },
        [&](std::size_t i, std::uint32_t at) { sorted[at] = crossings_[i]; });
    for (std::size_t r = 0; r + 1 < first.size(); ++r)
      std::sort(sorted.begin() + first[r], sorted.begin() + first[r + 1],
                [](const Crossing& a, const Crossing& b) { return a.x < b.x; });
    crossings_ = std::move(sorted);
  }

  double cell_;
  Extent cells_;
  std::size_t most_crossings_;
  std::vector<Crossing> crossings_;
  std::vector<std::int32_t> turns_;  // (cells_.width + 1) a row, where crossings are counted
};

}  // namespace

Mask rasterize(const ChartOutline& outline, const RasterOptions& options, Vec2d& origin) {
  const double c = options.factor * std::cos(options.angle);
  const double s = options.factor * std::sin(options.angle);
  const auto turn = [&](Vec2d p) { return Vec2d{c * p.x - s * p.y, s * p.x + c * p.y}; };
  origin = {};
  if (outline.empty()) return {};
  Bounds bx, by;
  const auto reach = [&](Vec2d p) {
    p = turn(p);
    bx.add(p.x);
    by.add(p.y);
  };
  for (const auto& e : outline.edges) reach(e.from);  // closed: every end is a beginning
  for (const auto& t : outline.loose) std::for_each(t.begin(), t.end(), reach);
  // The chart's lower left corner lies one padding inside its box's, so no cell is wasted there.
  origin = {options.padding - bx.low, options.padding - by.low};
  const auto place = [&](Vec2d p) {
    p = turn(p);
    return Vec2d{p.x + origin.x, p.y + origin.y};
  };
  const auto cells = [&](const Bounds& b) {
    return static_cast<std::int32_t>((b.high - b.low + 2 * options.padding) / options.cell) + 2;
  };
  RunSet set(cells(by));
  set.items.reserve(4 * (outline.edges.size() + outline.loose.size()));
  Interior interior(options.cell, {cells(bx), cells(by)});
  for (const auto& e : outline.edges) {
    const Vec2d a = place(e.from), b = place(e.to);
    add_edge(a, b, options, set);
    interior.add(a, b);
  }
  interior.fill(set);
  for (const auto& t : outline.loose)
    add_triangle({place(t[0]), place(t[1]), place(t[2])}, options, set);
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

Mask half_turn(const Mask& mask) {
  Mask turned = mask;
  std::reverse(turned.runs.begin(), turned.runs.end());
  for (Run& run : turned.runs) run = {mask.width - run.end, mask.width - run.begin};
  std::reverse(turned.first.begin(), turned.first.end());
  for (std::uint32_t& first : turned.first) first = mask.first.back() - first;
  return turned;
}

bool overlap(const Mask& a, const Mask& b, std::int32_t dx, std::int32_t dy) {
  if (dx >= a.width || dx + b.width <= 0) return false;
  for (std::int32_t r = std::max(0, dy); r < std::min(a.height, dy + b.height); ++r) {
    const std::span<const Run> in_a = a.row(r), in_b = b.row(r - dy);
    for (std::size_t i = 0, j = 0; i < in_a.size() && j < in_b.size();) {
      if (in_a[i].begin < in_b[j].end + dx && in_b[j].begin + dx < in_a[i].end) return true;
      in_a[i].end < in_b[j].end + dx ? ++i : ++j;
    }
  }
  return false;
}

Mask coarsen(const Mask& mask, std::int32_t factor) {
  RunSet set;
  for (std::int32_t r = 0; r < mask.height; ++r)
    for (const Run& run : mask.row(r))
      set.items.push_back({r / factor, {run.begin / factor, (run.end + factor - 1) / factor}});
  return set.build();
}

}  // namespace atlas::pack
