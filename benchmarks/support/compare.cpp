#include "benchmarks/support/compare.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace atlas::bench {
namespace {

struct Threshold {
  double relative, absolute;
  bool worse(double base, double head) const {
    if (std::isnan(head)) return !std::isnan(base);
    return head > base + std::abs(base) * relative && head > base + absolute;
  }
};

class Comparison {
 public:
  explicit Comparison(const CompareOptions& o)
      : quality_{o.quality_relative, o.quality_absolute},
        instructions_{o.instructions_relative, o.instructions_absolute},
        time_{o.time_relative, o.time_absolute},
        memory_{o.memory_relative, o.memory_absolute} {}

  void rows(const Row& base, const Row& head) {
    if (!base.failure.empty()) return;
    if (!head.failure.empty()) return add(Regression::failed, base.key() + ": " + head.failure);
    if (!base.values.empty()) {
      const auto& [name, error] = base.values.front();
      figure(Regression::quality, base.key() + ": " + name, error, head.value(name, NAN));
    }
    if (base.instructions > 0 && head.instructions > 0) {
      figure(Regression::instructions, base.key() + ": instructions", base.instructions,
             head.instructions);
      return;  // under callgrind, times and memory have no meaning
    }
    figure(Regression::time, base.key() + ": CPU s", base.cpu_seconds, head.cpu_seconds);
    figure(Regression::memory, base.key() + ": MiB", base.memory_mib, head.memory_mib);
  }

  void add(Regression::Kind kind, std::string what) { found.push_back({kind, std::move(what)}); }

  std::vector<Regression> found;

 private:
  void figure(Regression::Kind kind, const std::string& name, double base, double head) {
    const Threshold& limit = kind == Regression::quality        ? quality_
                             : kind == Regression::instructions ? instructions_
                             : kind == Regression::time         ? time_
                                                                : memory_;
    if (limit.worse(base, head)) add(kind, fmt::format("{} {:.5g} -> {:.5g}", name, base, head));
  }

  Threshold quality_, instructions_, time_, memory_;
};

template <class List, class Same>
auto find_in(const List& list, const Same& same) {
  const auto found = std::find_if(list.begin(), list.end(), same);
  return found == list.end() ? nullptr : &*found;
}

}  // namespace

std::vector<Regression> compare(const Results& base, const Results& head,
                                const CompareOptions& options) {
  Comparison comparison(options);
  for (const Row& row : base.rows) {
    const Row* other = find_in(head.rows, [&](const Row& r) { return r.key() == row.key(); });
    if (other)
      comparison.rows(row, *other);
    else
      comparison.add(Regression::missing, row.key() + ": no such row any more");
  }
  for (const Check& check : base.checks) {
    const auto same = [&](const Check& c) {
      return c.group == check.group && c.stress == check.stress && c.quantity == check.quantity;
    };
    const std::string name = check.group + " | " + check.stress + " | " + check.quantity;
    const Check* other = find_in(head.checks, same);
    if (!other)
      comparison.add(Regression::missing, name + ": no such check any more");
    else if (check.holds() && !other->holds())
      comparison.add(Regression::quality,
                     fmt::format("{} {:.4g} exceeds {:.4g}", name, other->value, other->bound));
  }
  std::stable_sort(comparison.found.begin(), comparison.found.end(),
                   [](const Regression& a, const Regression& b) { return a.kind < b.kind; });
  return comparison.found;
}

}  // namespace atlas::bench
