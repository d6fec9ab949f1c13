// Internal: collects the runs that make up a mask: cells along a chart's edges, and the cells
// between them.
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "libatlas/core/counting_sort.h"
#include "libatlas/core/sort_total.h"
#include "libatlas/pack/outlines/outline_mask.h"

namespace atlas::pack {

// The same as std::floor and std::ceil. Those are function calls if the build has to support old
// processors, and rasterising calls them millions of times.
inline std::int32_t floor_of(double v) {
  const auto whole = static_cast<std::int32_t>(v);
  return whole - (v < whole);
}
inline std::int32_t ceiling(double v) {
  const auto whole = static_cast<std::int32_t>(v);
  return whole + (v > whole);
}

// Collects runs in any order, then sorts them by row and joins those that touch.
class RunSet {
 public:
  struct Item {
    std::int32_t row;
    Run run;
  };
  std::vector<Item> items;

  // add() may join runs in rows 0 .. rows - 1.
  explicit RunSet(std::int32_t rows = 0) : last_(static_cast<std::size_t>(rows), kNone) {}

  // Adds a run. If it touches the last run added in its row, that run is extended instead, which is
  // the usual case for consecutive edges. Otherwise outlines with teeth finer than cells would take
  // gigabytes.
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
  // Sets mask.first to the index of the first run of every row.
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
      sort_total(runs.begin() + from, runs.begin() + to, [](const Run& a, const Run& b) {
        return std::pair(a.begin, a.end) < std::pair(b.begin, b.end);
      });
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
  std::vector<std::uint32_t> last_;  // one per row: the index of the item added last
  std::int32_t left_ = 0, bottom_ = 0;
};

// Finds the cells whose centres the edges wind around. Cells that are nearer to an edge are left to
// add_edge().
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
    // The rows whose middle lies in [a.y, b.y).
    const std::int32_t first = first_beyond(a.y), end = first_beyond(b.y);
    if (first >= end) return;
    const double slope = (b.x - a.x) / (b.y - a.y);
    for (std::int32_t r = first; r < end; ++r)
      crossings_.push_back({r, sense, a.x + slope * ((r + 0.5) * cell_ - a.y)});
    if (crossings_.size() > most_crossings_) count();
  }

  // first_beyond() returns the first cell whose centre is not left of x, last_before() the last
  // cell whose centre is not right of x. For rows the same holds with below and above.
  std::int32_t first_beyond(double x) const { return ceiling(x / cell_ - 0.5); }
  std::int32_t last_before(double x) const { return floor_of(x / cell_ - 0.5); }

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
      const std::int32_t end = last_before(next.x) + 1;
      if (begin < end) set.add(c.row, {begin, end});
    }
  }

 private:
  struct Crossing {
    std::int32_t row, sense;
    double x;
  };
  static constexpr std::size_t kManyCrossings = 1 << 21;  // 32 MiB

  // If the crossings would take more memory than the cells, they are added up per cell: each is
  // counted at the first cell that it affects.
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

  // Sorts the crossings by row, in time linear in crossings and rows, and then the few crossings of
  // each row by x.
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
      sort_total(sorted.begin() + first[r], sorted.begin() + first[r + 1],
                 [](const Crossing& a, const Crossing& b) {
                   return std::pair(a.x, a.sense) < std::pair(b.x, b.sense);
                 });
    crossings_ = std::move(sorted);
  }

  double cell_;
  Extent cells_;
  std::size_t most_crossings_;
  std::vector<Crossing> crossings_;
  // There are cells_.width + 1 entries per row. Used if crossings are counted.
  std::vector<std::int32_t> turns_;
};

}  // namespace atlas::pack
