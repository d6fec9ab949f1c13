#include "libatlas/pack/outlines/outline_mask.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "libatlas/core/portable_math.h"
#include "libatlas/pack/outlines/mask_runs.h"

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

// Returns the x range of a triangle within the slab low <= y <= high. The triangle must enter the
// slab.
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

// The rows [first, last] whose widened open slab (r cell - pad, (r + 1) cell + pad) meets [low,
// high].
struct Rows {
  std::int32_t first, last;
  Rows(const Bounds& y, double pad, double cell) {
    const std::int32_t below = floor_of((y.low - pad) / cell);
    const std::int32_t row0 = below - (below == (y.low - pad) / cell);
    first = row0 + ((row0 + 1) * cell + pad <= y.low);
    last = floor_of((y.high + pad) / cell);
    last -= last * cell - pad >= y.high;
  }
};

// Returns the cells of a row whose widened open interval meets [x.low, x.high].
Run cells_within(const Bounds& x, double pad, double cell) {
  std::int32_t begin = floor_of((x.low - pad) / cell);
  while ((begin + 1) * cell + pad <= x.low) ++begin;
  std::int32_t end = ceiling((x.high + pad) / cell);
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

// All that a mask can distinguish about an x coordinate.
struct Column {
  Run cells;                 // the cells that a point at this x touches
  std::int32_t left, right;  // the cells between whose centres it lies
  bool operator==(const Column&) const = default;
};

// Draws consecutive edges. Edges that stay within one column, which are thousands for teeth finer
// than cells, are drawn together: they touch all rows from their lowest to their highest point, and
// what they enclose depends only on their two ends.
class EdgePen {
 public:
  EdgePen(const RasterOptions& options, RunSet& set, Interior& interior)
      : options_(options), set_(set), interior_(interior) {}

  void move_to(Vec2d p) {
    finish();
    begin_at(p);
  }

  void draw_to(Vec2d p) {
    std::optional<Column> column;
    if (std::abs(p.x - at_.x) < options_.cell) {  // otherwise it is another column in any case
      if (!column_) column_ = column_of(at_.x);
      column = column_of(p.x);
      if (column == column_) {
        at_ = p;
        rows_.add(p.y);
        drawn_ = true;
        return;
      }
    }
    finish();
    add_edge(at_, p, options_, set_);
    interior_.add(at_, p);
    begin_at(p);
    column_ = column;
  }

  void finish() {
    if (!drawn_) return;
    const Rows rows(rows_, options_.padding, options_.cell);
    for (std::int32_t r = rows.first; r <= rows.last; ++r) set_.add(r, column_->cells);
    interior_.add(from_, at_);
  }

 private:
  Column column_of(double x) const {
    Bounds at;
    at.add(x);
    return {cells_within(at, options_.padding, options_.cell), interior_.first_beyond(x),
            interior_.last_before(x)};
  }

  void begin_at(Vec2d p) {
    from_ = at_ = p;
    column_.reset();
    drawn_ = false;
    rows_ = {};
    rows_.add(p.y);
  }

  const RasterOptions& options_;
  RunSet& set_;
  Interior& interior_;
  Vec2d from_, at_;               // ends of the part drawn in this column
  std::optional<Column> column_;  // the column of at_, if it has been computed
  Bounds rows_;
  bool drawn_ = false;  // whether an edge lies within the column
};

}  // namespace

Mask rasterize(const ChartOutline& outline, const RasterOptions& options, Vec2d& origin) {
  const double c = options.factor * portable::cos(options.angle);
  const double s = options.factor * portable::sin(options.angle);
  const auto turn = [&](Vec2d p) { return Vec2d{c * p.x - s * p.y, s * p.x + c * p.y}; };
  origin = {};
  if (outline.empty()) return {};
  Bounds bx, by;
  const auto reach = [&](Vec2d p) {
    p = turn(p);
    bx.add(p.x);
    by.add(p.y);
  };
  // Loops are closed: every end begins an edge.
  for (const auto& e : outline.edges) reach(e.from);
  for (const auto& t : outline.loose) std::for_each(t.begin(), t.end(), reach);
  // Without a shift, the chart's lower left corner lies one padding inside that of its box, so no
  // cell is wasted there.
  origin = {options.padding - bx.low + options.shift.x, options.padding - by.low + options.shift.y};
  const auto place = [&](Vec2d p) {
    p = turn(p);
    return Vec2d{p.x + origin.x, p.y + origin.y};
  };
  const auto cells = [&](const Bounds& b) {
    return static_cast<std::int32_t>((b.high - b.low + 2 * options.padding) / options.cell) + 3;
  };
  RunSet set(cells(by));
  set.items.reserve(4 * (outline.edges.size() + outline.loose.size()));
  Interior interior(options.cell, {cells(bx), cells(by)});
  EdgePen pen(options, set, interior);
  for (std::size_t k = 0; k < outline.edges.size(); ++k) {
    const ChartOutline::Edge& e = outline.edges[k];
    if (k == 0 || !(outline.edges[k - 1].to == e.from)) pen.move_to(place(e.from));
    pen.draw_to(place(e.to));
  }
  pen.finish();
  interior.fill(set);
  for (const auto& t : outline.loose)
    add_triangle({place(t[0]), place(t[1]), place(t[2])}, options, set);
  Mask mask = set.build();
  origin.x -= double(set.left()) * options.cell;
  origin.y -= double(set.bottom()) * options.cell;
  return mask;
}

Mask quarter_turn(const Mask& mask) {
  // (x, y) moves to (height - 1 - y, x), so a row of the result is a column of the input. A run of
  // the column begins or ends where a row differs from the one below it. The difference of two rows
  // is found by sorting the ends of their runs and taking these in pairs.
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

Mask join(std::span<const MaskAt> masks) {
  RunSet set;
  for (const auto& [mask, x, y] : masks)
    for (std::int32_t r = 0; r < mask.height; ++r)
      for (const Run& run : mask.row(r)) set.items.push_back({r + y, {run.begin + x, run.end + x}});
  return set.build();
}

Mask coarsen(const Mask& mask, std::int32_t factor) {
  RunSet set;
  for (std::int32_t r = 0; r < mask.height; ++r)
    for (const Run& run : mask.row(r))
      set.items.push_back({r / factor, {run.begin / factor, (run.end + factor - 1) / factor}});
  return set.build();
}

}  // namespace atlas::pack
