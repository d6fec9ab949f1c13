#include "libatlas/charts/flattening/flatten.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "libatlas/charts/flattening/absorb.h"
#include "libatlas/charts/flattening/chart_job.h"
#include "libatlas/charts/seams/straighten.h"
#include "libatlas/core/clock.h"
#include "libatlas/core/parallel.h"
#include "libatlas/core/pool.h"
#include "libatlas/core/sort_total.h"

namespace atlas {
namespace {

// The border between parts of a divided chart is straightened within a band whose width on each
// side is this share of the smaller part's width.
constexpr double kPartBand = 0.5;

// Memory used for a chart of more triangles is freed before a chart less than half as large, since
// the flat charts need memory by then.
constexpr std::size_t kLargeScratch = 40000;

void fit_scratch(std::size_t triangles, ChartScratch& scratch) {
  if (scratch.largest > kLargeScratch && triangles < scratch.largest / 2) {
    ChartScratch smaller;
    smaller.cuts_cpu = scratch.cuts_cpu;
    smaller.workspace.timing = scratch.workspace.timing;
    scratch = std::move(smaller);
    return_freed_memory();
  }
  scratch.largest = std::max(scratch.largest, triangles);
}

// Flattens in rounds all charts that remain to be flattened. Charts of a round run in parallel;
// between rounds the partition is changed, in order.
class Flattener {
 public:
  Flattener(const FlattenInput& input, Partition& partition)
      : input_(input), partition_(partition), splits_(input.topology.component_count) {}

  void run(const Context& context) {
    partition_.local.resize(partition_.chart.size());
    partition_.seams.resize(partition_.chart.size(), 0);
    list_charts();
    while (!todo_.empty() && !context.cancelled()) {
      std::stable_sort(todo_.begin(), todo_.end(), [&](std::uint32_t a, std::uint32_t b) {
        return charts_[a].triangles.size() > charts_[b].triangles.size();
      });
      // Only failures are stored: many scenes have 10^5 charts and few failures.
      std::vector<std::unique_ptr<ChartOutcome>> failures(todo_.size());
      const std::size_t grain = todo_.size() > 512 ? 16 : 1;
      parallel_for(context, todo_.size(), grain, [&](std::size_t begin, std::size_t end) {
        auto scratch = pool_.take();
        for (std::size_t i = begin; i < end; ++i) {
          const std::vector<std::uint32_t>& triangles = charts_[todo_[i]].triangles;
          fit_scratch(triangles.size(), *scratch);
          ChartOutcome outcome =
              flatten_chart(input_, partition_, {.triangles = triangles}, *scratch);
          if (outcome.parts.empty()) {
            flats_[todo_[i]] = std::move(outcome.flat);
          } else {
            failures[i] = std::make_unique<ChartOutcome>(std::move(outcome));
          }
        }
        pool_.give(std::move(scratch));
      });
      if (!context.cancelled()) settle(failures, context);
    }
  }

  FlattenResult take_result(const Context& context) {
    FlattenResult result;
    for (const auto& scratch : pool_.idle()) {
      result.timing.cuts_cpu += scratch->cuts_cpu;
      result.timing.solve_cpu += scratch->workspace.timing.solve;
      result.timing.flips_cpu += scratch->workspace.timing.flips;
      result.timing.overlaps_cpu += scratch->workspace.timing.overlaps;
    }
    result.splits = std::move(splits_);
    for (std::size_t k = 0; k < charts_.size(); ++k) {
      flats_[k].triangles = std::move(charts_[k].triangles);
      flats_[k].fragment = charts_[k].fragment || input_.options.cone_degrees > 0;
    }
    charts_ = {};
    result.charts = std::move(flats_);
    std::erase_if(result.charts, [](const FlatChart& chart) { return chart.triangles.empty(); });
    Stopwatch watch(own_cpu_seconds);
    const auto scratch = pool_.take();
    absorb_charts({input_, partition_, *scratch}, result.charts, context);
    result.timing.absorb_cpu = watch.lap();
    sort_total(result.charts.begin(), result.charts.end(),
               [](const FlatChart& a, const FlatChart& b) {
                 return a.triangles.front() < b.triangles.front();
               });
    return result;
  }

 private:
  struct State {
    std::vector<std::uint32_t> triangles;  // ascending
    bool fragment = false;
  };

  // Renumbers charts by their first triangle.
  void list_charts() {
    std::vector<std::uint32_t> place, size;
    for (std::uint32_t& chart : partition_.chart) {
      if (chart == kNoIndex) continue;
      if (chart >= place.size()) place.resize(chart + 1, kNoIndex);
      if (place[chart] == kNoIndex) {
        place[chart] = static_cast<std::uint32_t>(size.size());
        size.push_back(0);
      }
      chart = place[chart];
      ++size[chart];
    }
    charts_.reserve(size.size());
    flats_.reserve(size.size());
    todo_.reserve(size.size());
    for (const std::uint32_t triangles : size) charts_[add_chart()].triangles.reserve(triangles);
    for (std::uint32_t t = 0; t < partition_.chart.size(); ++t) {
      if (partition_.chart[t] != kNoIndex) charts_[partition_.chart[t]].triangles.push_back(t);
    }
  }

  std::uint32_t add_chart() {
    const auto id = static_cast<std::uint32_t>(charts_.size());
    charts_.emplace_back();
    flats_.emplace_back();
    todo_.push_back(id);
    return id;
  }

  void settle(std::vector<std::unique_ptr<ChartOutcome>>& failures, const Context& context) {
    const std::vector<std::uint32_t> done = std::move(todo_);
    todo_.clear();
    for (std::size_t i = 0; i < done.size(); ++i) {
      if (!failures[i]) continue;
      splits_[input_.topology.component[charts_[done[i]].triangles.front()]] += failures[i]->failed;
      divide(done[i], failures[i]->parts);
    }
    straighten_parts(context);
  }

  void divide(std::uint32_t chart, const std::vector<std::uint8_t>& parts) {
    const std::vector<std::uint32_t> triangles = std::move(charts_[chart].triangles);
    charts_[chart].triangles.clear();
    std::vector<std::uint32_t> name(1 + *std::max_element(parts.begin(), parts.end()), kNoIndex);
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      const std::uint32_t t = triangles[i];
      std::uint32_t& id = name[parts[i]];
      if (id == kNoIndex) id = parts[i] == 0 ? chart : add_chart();
      partition_.chart[t] = id;
      partition_.seams[t] = 0;
      charts_[id].triangles.push_back(t);
      charts_[id].fragment = true;
    }
    todo_.push_back(chart);
    parts_.push_back(chart);
    for (const std::uint32_t id : name) {
      if (id != chart && id != kNoIndex) parts_.push_back(id);
    }
  }

  // Straightens the borders between the parts of divided charts, which are ragged.
  void straighten_parts(const Context& context) {
    const std::vector<std::uint32_t> parts = std::exchange(parts_, {});
    if (parts.empty() || input_.options.cone_degrees > 0) return;
    std::vector<std::uint8_t> rings(charts_.size());
    std::vector<std::uint32_t> triangles;
    for (const std::uint32_t part : parts) {
      std::vector<std::uint32_t>& own = charts_[part].triangles;
      const double width = kPartBand * std::sqrt(static_cast<double>(own.size()));
      rings[part] = static_cast<std::uint8_t>(std::min(255.0, width));
      triangles.insert(triangles.end(), own.begin(), own.end());
      own.clear();
    }
    std::sort(triangles.begin(), triangles.end());
    const StraightenOptions options{{input_.options.crease_degrees, {}}, rings, triangles};
    carry_frames(input_.topology, straighten_borders(input_.topology, options, partition_, context),
                 input_.frames);
    for (const std::uint32_t t : triangles) charts_[partition_.chart[t]].triangles.push_back(t);
  }

  const FlattenInput& input_;
  Partition& partition_;
  Pool<ChartScratch> pool_;
  std::vector<State> charts_;
  std::vector<FlatChart> flats_;  // results by chart; triangles are filled in at the end
  std::vector<std::uint32_t> todo_;
  std::vector<std::uint32_t> parts_;   // parts of charts that were divided in this round
  std::vector<std::uint32_t> splits_;  // one per piece: charts that were divided
};

}  // namespace

FlattenResult flatten_charts(const FlattenInput& input, Partition& partition,
                             const Context& context) {
  Flattener flattener(input, partition);
  flattener.run(context);
  return flattener.take_result(context);
}

}  // namespace atlas
