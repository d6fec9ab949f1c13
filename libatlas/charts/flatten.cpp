#include "libatlas/charts/flatten.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <mutex>
#include <utility>

#include "libatlas/charts/absorb.h"
#include "libatlas/charts/chart_job.h"
#include "libatlas/core/parallel.h"

namespace atlas {
namespace {

// How often a chart may lose triangles to its neighbours before it is divided.
constexpr int kMaxRemovals = 4;

constexpr double kRemovalWidth = 1.0 / 60;

// One scratch a running thread, handed out and taken back.
class ScratchPool {
 public:
  std::unique_ptr<ChartScratch> take() {
    const std::lock_guard lock(mutex_);
    if (free_.empty()) return std::make_unique<ChartScratch>();
    auto scratch = std::move(free_.back());
    free_.pop_back();
    return scratch;
  }
  void give(std::unique_ptr<ChartScratch> scratch) {
    const std::lock_guard lock(mutex_);
    free_.push_back(std::move(scratch));
  }

 private:
  std::mutex mutex_;
  std::vector<std::unique_ptr<ChartScratch>> free_;
};

// Rounds over all charts that still have to be flattened. Charts run in parallel; what changes the
// partition happens between rounds, in order.
class Flattener {
 public:
  Flattener(const FlattenInput& input, Partition& partition)
      : input_(input), partition_(partition) {}

  void run(const Context& context) {
    partition_.local.resize(partition_.chart.size());
    partition_.seams.resize(partition_.chart.size(), 0);
    list_charts();
    while (!todo_.empty() && !context.cancelled()) {
      std::stable_sort(todo_.begin(), todo_.end(), [&](std::uint32_t a, std::uint32_t b) {
        return charts_[a].triangles.size() > charts_[b].triangles.size();
      });
      std::vector<ChartOutcome> outcomes(todo_.size());
      const std::size_t grain = todo_.size() > 512 ? 16 : 1;
      parallel_for(context, todo_.size(), grain, [&](std::size_t begin, std::size_t end) {
        auto scratch = pool_.take();
        for (std::size_t i = begin; i < end; ++i) {
          const State& state = charts_[todo_[i]];
          outcomes[i] = flatten_chart(input_, partition_, state.triangles,
                                      {.rings = removal_rings(state)}, *scratch);
        }
        pool_.give(std::move(scratch));
      });
      if (!context.cancelled()) settle(outcomes);
    }
  }

  FlattenResult take_result(const Context& context) {
    FlattenResult result;
    result.split_charts = split_;
    for (State& state : charts_) {
      if (state.triangles.empty()) continue;
      state.flat.fragment = state.fragment;
      result.charts.push_back(std::move(state.flat));
    }
    if (split_ > 0 || input_.options.cone_degrees > 0) {
      const auto scratch = pool_.take();
      absorb_fragments({input_, partition_, *scratch}, result.charts, context);
    }
    std::sort(result.charts.begin(), result.charts.end(),
              [](const FlatChart& a, const FlatChart& b) {
                return a.triangles.front() < b.triangles.front();
              });
    return result;
  }

 private:
  struct State {
    std::vector<std::uint32_t> triangles;  // ascending
    FlatChart flat;
    int removals = 0;
    bool queued = false;
    bool fragment = false;
  };

  // Rings of triangles to remove around a crossing: a little of the chart's width at first, twice
  // as much each time.
  static int removal_rings(const State& state) {
    const double width = std::sqrt(static_cast<double>(state.triangles.size()));
    return std::max(1, static_cast<int>(kRemovalWidth * width)) << state.removals;
  }

  // Numbers charts anew, by first triangle.
  void list_charts() {
    std::vector<std::uint32_t> place;
    for (std::uint32_t t = 0; t < partition_.chart.size(); ++t) {
      std::uint32_t& chart = partition_.chart[t];
      if (chart == kNoIndex) continue;
      if (chart >= place.size()) place.resize(chart + 1, kNoIndex);
      if (place[chart] == kNoIndex) place[chart] = add_chart();
      chart = place[chart];
      charts_[chart].triangles.push_back(t);
    }
  }

  std::uint32_t add_chart() {
    const auto id = static_cast<std::uint32_t>(charts_.size());
    charts_.emplace_back();
    queue(id);
    return id;
  }

  void queue(std::uint32_t chart) {
    if (charts_[chart].queued) return;
    charts_[chart].queued = true;
    todo_.push_back(chart);
  }

  void settle(std::vector<ChartOutcome>& outcomes) {
    const std::vector<std::uint32_t> done = std::move(todo_);
    todo_.clear();
    for (const std::uint32_t chart : done) charts_[chart].queued = false;
    for (std::size_t i = 0; i < done.size(); ++i) {
      if (outcomes[i].parts.empty()) charts_[done[i]].flat = std::move(outcomes[i].flat);
    }
    moved_.clear();
    for (std::size_t i = 0; i < done.size(); ++i) {
      if (outcomes[i].parts.empty()) continue;
      if (remove(done[i], outcomes[i].remove)) continue;
      split_ += outcomes[i].failed;
      divide(done[i], outcomes[i].parts);
    }
    for (const std::uint32_t t : moved_) queue(partition_.chart[t]);
    relist();
  }

  // False if not all could go.
  bool remove(std::uint32_t chart, const std::vector<std::uint32_t>& triangles) {
    if (triangles.empty() || charts_[chart].removals >= kMaxRemovals) return false;
    ++charts_[chart].removals;
    bool any = false;
    for (const std::uint32_t t : triangles) {
      const std::uint32_t h = way_out(t);
      if (h == kNoIndex || !removable(input_.topology, partition_, t)) continue;
      move_triangle(input_.topology, h, partition_, input_.frames);
      moved_.push_back(t);
      any = true;
    }
    if (any) queue(chart);
    return any;
  }

  // The longest edge of t to another chart.
  std::uint32_t way_out(std::uint32_t t) const {
    std::uint32_t best = kNoIndex;
    double longest = 0;
    for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
      const std::uint32_t o = input_.topology.opposite[h];
      if (o == kNoIndex || partition_.chart[o / 3] == partition_.chart[t]) continue;
      const double length = edge_length(input_.topology, h);
      if (length <= longest) continue;
      longest = length;
      best = h;
    }
    return best;
  }

  void divide(std::uint32_t chart, const std::vector<std::uint8_t>& parts) {
    // Triangles that came from neighbours in this round stay with part 0.
    const std::vector<std::uint32_t> triangles = std::move(charts_[chart].triangles);
    charts_[chart].triangles.clear();
    std::vector<std::uint32_t> name(1 + *std::max_element(parts.begin(), parts.end()), kNoIndex);
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      const std::uint32_t t = triangles[i];
      if (partition_.chart[t] != chart) continue;
      std::uint32_t& id = name[parts[i]];
      if (id == kNoIndex) id = parts[i] == 0 ? chart : add_chart();
      partition_.chart[t] = id;
      partition_.seams[t] = 0;
      charts_[id].triangles.push_back(t);
      charts_[id].fragment = true;
    }
    queue(chart);
  }

  // Brings the lists up to date with the partition after triangles moved.
  void relist() {
    if (moved_.empty()) return;
    for (const std::uint32_t chart : todo_) {
      std::erase_if(charts_[chart].triangles,
                    [&](std::uint32_t t) { return partition_.chart[t] != chart; });
    }
    std::sort(moved_.begin(), moved_.end());
    moved_.erase(std::unique(moved_.begin(), moved_.end()), moved_.end());
    for (const std::uint32_t t : moved_) {
      auto& list = charts_[partition_.chart[t]].triangles;
      const auto at = std::lower_bound(list.begin(), list.end(), t);
      if (at == list.end() || *at != t) list.insert(at, t);
    }
    std::erase_if(todo_, [&](std::uint32_t chart) { return charts_[chart].triangles.empty(); });
  }

  const FlattenInput& input_;
  Partition& partition_;
  ScratchPool pool_;
  std::vector<State> charts_;
  std::vector<std::uint32_t> todo_, moved_;
  std::uint64_t split_ = 0;
};

}  // namespace

FlattenResult flatten_charts(const FlattenInput& input, Partition& partition,
                             const Context& context) {
  Flattener flattener(input, partition);
  flattener.run(context);
  return flattener.take_result(context);
}

}  // namespace atlas
