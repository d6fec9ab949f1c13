#include "benchmarks/support/compare.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace atlas::bench {
namespace {

struct Figure {
  const char* name;
  Better better;
  double perfect = 0;  // errors are differences from it
};
// The qualities by the names of Row::values. Parts of a time ("..._cpu") are none.
constexpr Figure kFigures[] = {
    // charts and unwrap
    {"seam", Better::lower},
    {"l2", Better::lower, 1},
    {"l2_minus_1", Better::lower},
    {"flips", Better::lower},
    {"overlap", Better::lower},
    {"bleed", Better::lower},
    {"flipped", Better::lower},
    {"without_uv", Better::lower},
    {"util", Better::higher},
    // pages and light
    {"empty", Better::lower},
    {"scale", Better::higher},
    {"pages", Better::lower},
    {"charts", Better::lower},
    {"rms", Better::lower},
    {"max", Better::lower},
    {"p50", Better::lower},
    {"p95", Better::lower},
    {"p99", Better::lower},
    {"p999", Better::lower},
    {"psnr", Better::higher},
    {"kept", Better::lower},
    {"fixed_p95", Better::lower},
    {"fixed_rms", Better::lower},
    {"object_p95", Better::lower},
    {"texel_mm", Better::lower},
    {"asked_mm", Better::neither},
    {"edge_m", Better::neither},
    // the other stages
    {"missing", Better::lower},
    {"normal_sum", Better::neither},
    {"imbalance", Better::lower},
    {"evaluations", Better::neither},
    {"proved", Better::higher},
    {"slip", Better::lower},
    {"turn", Better::lower},
    // shadows
    {"mean", Better::lower},
    {"wrong", Better::lower},
    {"mean_off_edges", Better::lower},
    {"ssim", Better::higher, 1},
    // conditioning
    {"condition", Better::neither},
    {"residual", Better::lower},
    {"error", Better::lower},
    {"direct_residual", Better::lower},
    {"multigrid_suffices", Better::higher},
    {"flips_without", Better::neither},
    {"flips_with", Better::lower},
    {"stretch_without", Better::neither},
    {"stretch_with", Better::lower, 1},
    {"injective", Better::higher},
    {"cost_times", Better::neither},
};

const Figure* find_figure(const std::string& name) {
  const auto found = std::find_if(std::begin(kFigures), std::end(kFigures),
                                  [&](const Figure& f) { return name == f.name; });
  return found == std::end(kFigures) ? nullptr : found;
}

// Returns by how much a value misses perfection, so that more is worse.
double error_of(const Row& row, const Figure& figure, double value) {
  double perfect = figure.perfect;
  // The same percentile is a stretch, which begins at 1, and an error of display values.
  if (std::string(figure.name) == "p999" && (row.stage == "charts" || row.stage == "unwrap"))
    perfect = 1;
  return figure.better == Better::lower ? value - perfect : perfect - value;
}

// Returns the name of what a stage should make few of, or "" if its `size_out` is no quality.
std::string count_of(const Row& row) {
  for (const char* stage : {"charts", "unwrap", "packing", "export"})
    if (row.stage == stage)
      return row.unit.substr(std::min(row.unit.size(), row.unit.rfind(' ') + 1));
  return "";
}

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
    for (const auto& [name, value] : base.values) quality(base, name, value, head);
    if (const std::string count = count_of(base); !count.empty())
      figure(Regression::quality, base.key() + ": " + count, double(base.size_out),
             double(head.size_out));
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
  void quality(const Row& base, const std::string& name, double value, const Row& head) {
    const Figure* known = find_figure(name);
    if (!known || known->better == Better::neither) return;
    const double now = head.value(name, NAN);
    if (quality_.worse(error_of(base, *known, value), error_of(base, *known, now)))
      add(Regression::quality,
          fmt::format("{}: {} {:.5g} -> {:.5g}", base.key(), name, value, now));
  }

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

Better better_of(const std::string& name) {
  if (name.ends_with("_cpu")) return Better::neither;
  const Figure* known = find_figure(name);
  return known ? known->better : Better::unknown;
}

std::vector<Regression> compare(const Results& base, const Results& head,
                                const CompareOptions& options) {
  CompareOptions own = options;
  if (machine_count(std::vector{base, head}) > 1)
    own.time_relative = std::numeric_limits<double>::infinity();
  Comparison comparison(own);
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
