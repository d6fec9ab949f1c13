// Internal: groups nearly equal costs of mergers, so that rounding does not decide which comes
// first.
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

namespace atlas {

// Gives all costs that differ by less than `tie` the value of the first of them. Symmetric meshes
// are full of ties, and rounding would otherwise break them differently for every rotation and
// unit.
class CostClasses {
 public:
  static constexpr double tie = 1e-4;
  // Costs are clamped to [-most, most]. NaN, the cost of cells without area, becomes `most`.
  static constexpr double most = 1e9;

  double operator()(double cost) {
    const double own = std::max(-most, std::min(most, cost)), low = own - tie, high = own + tie;
    if (2 * count_ >= table_.size()) grow();
    double least = kNone;
    for (std::int64_t c = cell(low), last = cell(high); c <= last; ++c) {
      for (std::size_t i = place(c); table_[i].value != kNone; i = (i + 1) & (table_.size() - 1)) {
        const double value = table_[i].value;
        if (table_[i].cell == c && value >= low && value <= high) least = std::min(least, value);
      }
    }
    if (least != kNone) return least;
    ++count_;
    put({cell(own), own});
    return own;
  }

 private:
  // A hash table of values, keyed by intervals as wide as `tie`. Each interval holds about one
  // value.
  struct Entry {
    std::int64_t cell = 0;
    double value = kNone;
  };
  static constexpr double kNone = 2 * most;

  static std::int64_t cell(double value) { return static_cast<std::int64_t>(value / tie); }
  std::size_t place(std::int64_t cell) const {
    return static_cast<std::uint64_t>(cell) * 0x9e3779b97f4a7c15ull >> shift_;
  }

  void put(const Entry& entry) {
    std::size_t i = place(entry.cell);
    while (table_[i].value != kNone) i = (i + 1) & (table_.size() - 1);
    table_[i] = entry;
  }

  void grow() {
    const std::vector<Entry> old =
        std::exchange(table_, std::vector<Entry>(std::max<std::size_t>(16, 2 * table_.size())));
    shift_ = table_.size() == 16 ? 60 : shift_ - 1;
    for (const Entry& entry : old) {
      if (entry.value != kNone) put(entry);
    }
  }

  std::vector<Entry> table_;
  std::size_t count_ = 0;
  int shift_ = 60;  // shifts a hash down to an index into the table
};

}  // namespace atlas
