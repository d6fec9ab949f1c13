#include "libatlas/charts/flatten.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <utility>

#include "libatlas/charts/split.h"
#include "libatlas/core/glm_bridge.h"
#include "libatlas/core/parallel.h"
#include "libatlas/param/orient.h"
#include "libatlas/param/parameterize.h"
#include "libatlas/param/planar.h"

namespace atlas {
namespace {

// A projection this close to isometric is taken without asking the solver.
constexpr double kPlanarStretch = 1.01;
constexpr double kFastPlanarStretch = 1.1;
// A chart with holes is tried uncut when it is not a tube; a tube's normals exceed this cone.
constexpr double kOpenCone = 85 * M_PI / 180;
// Altitude kept for slivers, relative to the square root of the chart's area.
constexpr double kMinAltitude = 1e-7;

struct Scratch {
  LocalChart chart;
  ParamWorkspace workspace;
  std::vector<std::array<Vec3d, 2>> frames;
  std::vector<std::array<std::uint32_t, 2>> border;
};

// One scratch a running thread, handed out and taken back.
class ScratchPool {
 public:
  std::unique_ptr<Scratch> take() {
    const std::lock_guard lock(mutex_);
    if (free_.empty()) return std::make_unique<Scratch>();
    auto scratch = std::move(free_.back());
    free_.pop_back();
    return scratch;
  }
  void give(std::unique_ptr<Scratch> scratch) {
    const std::lock_guard lock(mutex_);
    free_.push_back(std::move(scratch));
  }

 private:
  std::mutex mutex_;
  std::vector<std::unique_ptr<Scratch>> free_;
};

// What became of one chart: flat, or divided into parts.
struct Outcome {
  FlatChart flat;
  std::vector<std::uint8_t> parts;  // 1 a triangle; empty: flat holds the result
  bool failed = false;              // divided because it could not be flattened
};

class ChartJob {
 public:
  ChartJob(const FlattenInput& input, Partition& partition, Scratch& scratch)
      : input_(input), partition_(partition), scratch_(scratch), chart_(scratch.chart) {}

  Outcome run(std::span<const std::uint32_t> triangles) {
    build(triangles);
    Outcome outcome;
    if (chart_.component_count > 1) {
      outcome.parts = component_parts();
      return outcome;
    }
    if (beyond_cone()) {
      outcome.parts = halves();
      outcome.failed = true;
      return outcome;
    }
    for (;;) {
      const bool disc = chart_.euler() == 1;
      const auto loops = static_cast<int>(chart_.loops.size());
      const bool plane_topology = chart_.euler() == 2 - loops;  // genus 0
      if (loops > 0 && plane_topology && (disc || cone_.angle < kOpenCone) && flatten(outcome)) {
        return outcome;
      }
      if (disc || !plane_topology || !join_loops(input_.topology, chart_, partition_)) break;
      build(triangles);
    }
    outcome.parts = halves();
    outcome.failed = true;
    return outcome;
  }

 private:
  void build(std::span<const std::uint32_t> triangles) {
    chart_.build(input_.topology, partition_, triangles);
    if (!input_.density.empty()) {
      for (const std::uint32_t t : triangles) chart_.density.push_back(input_.density[t]);
    }
    cone_ = normal_cone(input_.topology.normals, triangles);
  }

  bool beyond_cone() const {
    return input_.options.cone_degrees > 0 && chart_.triangles().size() > 1 &&
           cone_.angle > input_.options.cone_degrees * M_PI / 180 * (1 + 1e-9);
  }

  std::vector<std::uint8_t> component_parts() const {
    std::vector<std::uint8_t> parts(chart_.component.size());
    for (std::size_t i = 0; i < parts.size(); ++i) {
      parts[i] = static_cast<std::uint8_t>(std::min(chart_.component[i], 255u));
    }
    return parts;
  }

  std::vector<std::uint8_t> halves() const {
    const auto pair = far_pair(input_.topology, chart_);
    return divide(input_.topology, chart_, pair);
  }

  ParamOptions param_options(const LocalMesh& mesh) {
    const ChartOptions& options = input_.options;
    ParamOptions param;
    param.max_stretch = options.max_stretch;
    param.max_planar_stretch =
        std::min(options.max_stretch,
                 options.preset == ChartPreset::fast ? kFastPlanarStretch : kPlanarStretch);
    param.axis = from_glm(glm::dvec3(to_glm(cone_.axis)));
    double area = 0;
    for (const std::uint32_t t : chart_.triangles()) area += input_.topology.areas[t];
    param.min_altitude = kMinAltitude * std::sqrt(area);
    if (!input_.frames.empty()) {
      scratch_.frames.resize(mesh.triangles.size());
      for (std::size_t i = 0; i < scratch_.frames.size(); ++i) {
        const auto& frame = input_.frames[chart_.triangles()[i]];
        scratch_.frames[i] = {from_glm(to_dvec(frame[0])), from_glm(to_dvec(frame[1]))};
      }
      param.start.frames = scratch_.frames;
    }
    return param;
  }

  bool flatten(Outcome& outcome) {
    const LocalMesh mesh = chart_.mesh();
    ParamResult result = parameterize(mesh, param_options(mesh), scratch_.workspace);
    const bool single = chart_.triangles().size() == 1;
    if (std::getenv("TRACE2") && !(result.injective && result.within_bound))
      fprintf(stderr,
              "  fail: tris %zu euler %d loops %zu inj %d bound %d s999 %.3f linf %.2f l2 %.4f "
              "flips %lu offenders %zu cross %zu unfl %d\n",
              mesh.triangles.size(), chart_.euler(), chart_.loops.size(), result.injective,
              result.within_bound, result.distortion.stretch_999, result.distortion.stretch_linf,
              result.distortion.stretch_l2, result.distortion.flips, result.offenders.size(),
              result.crossings.size(), result.unflipped);
    if (!single && !(result.injective && result.within_bound)) return false;
    FlatChart& flat = outcome.flat;
    flat.uvs = std::move(result.uvs);
    scratch_.border.clear();
    for (std::uint32_t h = 0; h < chart_.opposite.size(); ++h) {
      if (chart_.opposite[h] == kNoIndex) {
        scratch_.border.push_back({chart_.corners[h / 3][h % 3],
                                   chart_.corners[next_half_edge(h) / 3][next_half_edge(h) % 3]});
      }
    }
    flat.size = orient_for_packing(flat.uvs, scratch_.border).size;
    flat.triangles.assign(chart_.triangles().begin(), chart_.triangles().end());
    flat.corners = chart_.corners;
    flat.vertex = chart_.vertex;
    flat.cone = cone_;
    flat.distortion = result.distortion;
    flat.planar = result.planar;
    return true;
  }

  const FlattenInput& input_;
  Partition& partition_;
  Scratch& scratch_;
  LocalChart& chart_;
  NormalCone cone_;
};

using TriangleList = std::vector<std::uint32_t>;

// Lists of triangles, ascending; lists ordered by their first.
std::vector<TriangleList> list_charts(const Partition& partition) {
  std::vector<std::uint32_t> place;
  std::vector<TriangleList> lists;
  for (std::uint32_t t = 0; t < partition.chart.size(); ++t) {
    const std::uint32_t chart = partition.chart[t];
    if (chart == kNoIndex) continue;
    if (chart >= place.size()) place.resize(chart + 1, kNoIndex);
    if (place[chart] == kNoIndex) {
      place[chart] = static_cast<std::uint32_t>(lists.size());
      lists.emplace_back();
    }
    lists[place[chart]].push_back(t);
  }
  return lists;
}

std::vector<TriangleList> divide_list(const TriangleList& list,
                                      const std::vector<std::uint8_t>& parts) {
  const std::size_t count = 1 + *std::max_element(parts.begin(), parts.end());
  std::vector<TriangleList> lists(count);
  for (std::size_t i = 0; i < list.size(); ++i) lists[parts[i]].push_back(list[i]);
  return lists;
}

}  // namespace

FlattenResult flatten_charts(const FlattenInput& input, Partition& partition,
                             const Context& context) {
  FlattenResult result;
  partition.local.resize(partition.chart.size());
  partition.seams.resize(partition.chart.size(), 0);
  std::vector<TriangleList> todo = list_charts(partition);
  std::uint32_t next_chart = 0;
  for (const std::uint32_t chart : partition.chart) {
    if (chart != kNoIndex) next_chart = std::max(next_chart, chart + 1);
  }
  ScratchPool pool;
  while (!todo.empty() && !context.cancelled()) {
    std::stable_sort(todo.begin(), todo.end(), [](const TriangleList& a, const TriangleList& b) {
      return a.size() > b.size();
    });
    std::vector<Outcome> outcomes(todo.size());
    const std::size_t grain = todo.size() > 512 ? 16 : 1;
    parallel_for(context, todo.size(), grain, [&](std::size_t begin, std::size_t end) {
      auto scratch = pool.take();
      for (std::size_t i = begin; i < end; ++i) {
        outcomes[i] = ChartJob(input, partition, *scratch).run(todo[i]);
      }
      pool.give(std::move(scratch));
    });
    if (context.cancelled()) break;
    std::vector<TriangleList> again;
    for (std::size_t i = 0; i < todo.size(); ++i) {
      if (outcomes[i].parts.empty()) {
        result.charts.push_back(std::move(outcomes[i].flat));
        continue;
      }
      result.split_charts += outcomes[i].failed;
      for (TriangleList& part : divide_list(todo[i], outcomes[i].parts)) {
        if (part.empty()) continue;
        for (const std::uint32_t t : part) {
          partition.chart[t] = next_chart;
          partition.seams[t] = 0;
        }
        ++next_chart;
        again.push_back(std::move(part));
      }
    }
    todo = std::move(again);
  }
  std::sort(result.charts.begin(), result.charts.end(), [](const FlatChart& a, const FlatChart& b) {
    return a.triangles.front() < b.triangles.front();
  });
  return result;
}

}  // namespace atlas
