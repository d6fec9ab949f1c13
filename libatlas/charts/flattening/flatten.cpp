#include "libatlas/charts/flattening/flatten.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "libatlas/charts/flattening/absorb.h"
#include "libatlas/charts/flattening/chart_job.h"
#include "libatlas/charts/flattening/newcomers.h"
#include "libatlas/charts/flattening/relieve.h"
#include "libatlas/charts/seams/straighten.h"
#include "libatlas/core/clock.h"
#include "libatlas/core/parallel.h"
#include "libatlas/core/pool.h"

namespace atlas {
namespace {

// How often a chart may lose triangles to its neighbours before it is divided.
constexpr int kMaxRemovals = 4;

// If a border crosses itself more often than this, each removal of triangles must halve the number
// of crossings, or the chart is divided. Measured on 170 meshes: of 29 charts with seven or more
// crossings only 4 could be saved by removals.
constexpr std::size_t kManyCrossings = 6;
// Rings of triangles first removed around a crossing, as a share of the square root of the chart's
// triangles.
constexpr double kRemovalWidth = 1.0 / 60;

// The border between parts of a divided chart is straightened within a band whose width on each
// side is this share of the smaller part's width.
constexpr double kPartBand = 0.5;
constexpr float kPartStiffness = 0.03F;  // 0.3 gives a hundredth more charts (97 meshes)

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
          const ChartTask task = task_for(todo_[i]);
          fit_scratch(task.triangles.size(), *scratch);
          ChartOutcome outcome = flatten_chart(input_, partition_, task, *scratch);
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
    relieve_charts(input_, partition_, result.charts, context);
    result.timing.absorb_cpu = watch.lap();
    std::sort(result.charts.begin(), result.charts.end(),
              [](const FlatChart& a, const FlatChart& b) {
                return a.triangles.front() < b.triangles.front();
              });
    return result;
  }

 private:
  struct State {
    std::vector<std::uint32_t> triangles;  // ascending
    std::vector<Vec2d> uvs;                // three per triangle, to continue from, or empty
    int removals = 0;
    // Crossings at the last removal.
    std::size_t crossings = std::numeric_limits<std::size_t>::max();
    bool queued = false;
    bool grown = false;  // got triangles from neighbours since it was flattened
    bool fragment = false;
  };

  // Returns the number of rings of triangles to remove around a crossing: a small share of the
  // chart's width at first, doubled each time.
  static int removal_rings(const State& state) {
    const double width = std::sqrt(static_cast<double>(state.triangles.size()));
    return std::max(1, static_cast<int>(kRemovalWidth * width)) << state.removals;
  }

  ChartTask task_for(std::uint32_t chart) const {
    const State& state = charts_[chart];
    const bool was_flat = !state.uvs.empty() && !flats_[chart].corners.empty();
    return {.triangles = state.triangles,
            .rings = removal_rings(state),
            .resumed = state.uvs,
            .little = was_flat};
  }

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
    queue(id);
    return id;
  }

  void queue(std::uint32_t chart) {
    if (charts_[chart].queued) return;
    charts_[chart].queued = true;
    todo_.push_back(chart);
  }

  void settle(std::vector<std::unique_ptr<ChartOutcome>>& failures, const Context& context) {
    const std::vector<std::uint32_t> done = std::move(todo_);
    todo_.clear();
    for (const std::uint32_t chart : done) charts_[chart].queued = charts_[chart].grown = false;
    moved_.clear();
    for (std::size_t i = 0; i < done.size(); ++i) {
      if (!failures[i]) {
        charts_[done[i]].uvs = {};
        continue;
      }
      if (remove(done[i], *failures[i])) continue;
      splits_[input_.topology.component[charts_[done[i]].triangles.front()]] += failures[i]->failed;
      divide(done[i], failures[i]->parts);
    }
    straighten_parts(context);
    relist();
    if (!todo_.empty()) return;
    for (const std::uint32_t chart : std::exchange(grown_, {})) {
      if (charts_[chart].grown) queue(chart);
    }
  }

  // Gives the triangles listed by `failure` to neighbours. Returns false if none could be given
  // away, or if the last removal did not help enough.
  bool remove(std::uint32_t chart, ChartOutcome& failure) {
    State& state = charts_[chart];
    if (failure.remove.empty() || state.removals >= kMaxRemovals) return false;
    const std::size_t most =
        failure.crossings > kManyCrossings ? state.crossings / 2 : state.crossings;
    if (failure.crossings > most) return false;
    state.crossings = failure.crossings;
    ++state.removals;
    bool any = false;
    for (const std::uint32_t t : failure.remove) {
      const std::uint32_t h = way_out(t);
      if (h == kNoIndex || !removable(input_.topology, partition_, t)) continue;
      move_triangle(input_.topology, h, partition_, input_.frames);
      moved_.push_back(t);
      any = true;
    }
    if (!any) return false;
    state.uvs = std::move(failure.uvs);
    flats_[chart] = {};
    queue(chart);
    return true;
  }

  // Returns the longest edge of t that leads to another chart.
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
    // Triangles that came from neighbours in this round keep the chart's number, which becomes part
    // 0.
    const std::vector<std::uint32_t> triangles = std::move(charts_[chart].triangles);
    charts_[chart].triangles.clear();
    charts_[chart].uvs.clear();
    flats_[chart] = {};
    charts_[chart].crossings = State{}.crossings;
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
    parts_.push_back(chart);
    for (const std::uint32_t id : name) {
      if (id != chart && id != kNoIndex) parts_.push_back(id);
    }
  }

  // Straightens the borders between the parts of divided charts, which are ragged.
  void straighten_parts(const Context& context) {
    const std::vector<std::uint32_t> parts = std::exchange(parts_, {});
    if (parts.empty() || input_.options.cone_degrees > 0) return;
    std::vector<SeamBand> bands(charts_.size());
    std::vector<std::uint32_t> triangles;
    for (const std::uint32_t part : parts) {
      std::vector<std::uint32_t>& own = charts_[part].triangles;
      const double rings = kPartBand * std::sqrt(static_cast<double>(own.size()));
      bands[part] = {static_cast<std::uint8_t>(std::min(255.0, rings)), kPartStiffness};
      triangles.insert(triangles.end(), own.begin(), own.end());
      own.clear();
    }
    std::sort(triangles.begin(), triangles.end());
    const StraightenOptions options{{input_.options.crease_degrees, {}}, bands, triangles};
    carry_frames(input_.topology, straighten_borders(input_.topology, options, partition_, context),
                 input_.frames);
    for (const std::uint32_t t : triangles) charts_[partition_.chart[t]].triangles.push_back(t);
  }

  // Drops triangles that have gone to other charts from the chart's lists.
  void drop_lost(std::uint32_t chart) {
    State& state = charts_[chart];
    std::size_t kept = 0;
    for (std::size_t i = 0; i < state.triangles.size(); ++i) {
      if (partition_.chart[state.triangles[i]] != chart) continue;
      if (!state.uvs.empty()) std::copy_n(&state.uvs[3 * i], 3, &state.uvs[3 * kept]);
      state.triangles[kept++] = state.triangles[i];
    }
    state.triangles.resize(kept);
    if (!state.uvs.empty()) state.uvs.resize(3 * kept);
  }

  // Updates the lists after triangles moved in the partition.
  void relist() {
    if (moved_.empty()) return;
    for (const std::uint32_t chart : todo_) drop_lost(chart);
    std::sort(moved_.begin(), moved_.end());
    moved_.erase(std::unique(moved_.begin(), moved_.end()), moved_.end());
    add_moved();
    for (const std::uint32_t t : moved_) {
      if (!std::exchange(charts_[partition_.chart[t]].grown, true)) {
        grown_.push_back(partition_.chart[t]);
      }
    }
    std::erase_if(todo_, [&](std::uint32_t chart) { return charts_[chart].triangles.empty(); });
  }

  // Adds moved triangles to the lists of the charts that they now belong to.
  void add_moved() {
    std::vector<std::uint32_t> sorted = moved_;  // by chart, then ascending
    std::stable_sort(sorted.begin(), sorted.end(), [&](std::uint32_t a, std::uint32_t b) {
      return partition_.chart[a] < partition_.chart[b];
    });
    for (auto first = sorted.begin(), last = first; first != sorted.end(); first = last) {
      const std::uint32_t chart = partition_.chart[*first];
      while (last != sorted.end() && partition_.chart[*last] == chart) ++last;
      add_triangles(chart, {first, last});
    }
  }

  // Adds triangles (ascending) that are not yet in the chart's list.
  void add_triangles(std::uint32_t chart, std::vector<std::uint32_t> added) {
    State& state = charts_[chart];
    std::vector<std::uint32_t>& all = state.triangles;
    std::erase_if(added,
                  [&](std::uint32_t t) { return std::binary_search(all.begin(), all.end(), t); });
    if (added.empty()) return;
    if (state.uvs.empty()) {
      for (const auto& corners : flats_[chart].corners) {
        for (const std::uint32_t v : corners) state.uvs.push_back(flats_[chart].uvs[v]);
      }
    }
    const bool placed = !state.uvs.empty();
    std::size_t old = all.size(), at = old + added.size();
    all.resize(at);
    if (placed) state.uvs.resize(3 * at);
    while (!added.empty()) {  // from the end
      --at;
      const bool fresh = old == 0 || all[old - 1] < added.back();
      all[at] = fresh ? added.back() : all[--old];
      for (std::size_t i = 0; placed && i < 3; ++i) {
        state.uvs[3 * at + i] = fresh ? unplaced() : state.uvs[3 * old + i];
      }
      if (fresh) added.pop_back();
    }
  }

  const FlattenInput& input_;
  Partition& partition_;
  Pool<ChartScratch> pool_;
  std::vector<State> charts_;
  std::vector<FlatChart> flats_;  // results by chart; triangles are filled in at the end
  std::vector<std::uint32_t> todo_, moved_;
  std::vector<std::uint32_t> parts_;   // parts of charts that were divided in this round
  std::vector<std::uint32_t> grown_;   // charts that wait until no more triangles can arrive
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
