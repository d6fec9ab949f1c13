#include "libatlas/charts/flattening/chart_job.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "libatlas/charts/flattening/split.h"
#include "libatlas/charts/merging/unroll.h"
#include "libatlas/core/clock.h"
#include "libatlas/core/degrees.h"
#include "libatlas/core/glm_bridge.h"
#include "libatlas/param/descent/flatten_disc.h"
#include "libatlas/param/orient.h"

namespace atlas {
namespace {

// A projection this close to isometric is accepted without calling the solver.
constexpr double kPlanarStretch = 1.001;
constexpr double kFastPlanarStretch = 1.1;
// Charts within a narrower cone are left to the projection, and not unrolled.
constexpr double kFlatCone = radians(1);
// Borders closer to each other than this share of the square root of the chart's area touch. Equal
// sides come to lie on each other when parts unroll, and rounding would decide whether they cross.
constexpr double kTouching = 2e-6;
// A chart with holes is tried uncut if its cone is narrower; the normals of a tube exceed this.
constexpr double kOpenCone = radians(85);
constexpr int kSmallHole = 16, kLongestSlit = 100;  // edges
// The altitude that slivers keep, relative to the square root of the chart's area.
constexpr double kMinAltitude = 1e-7;

// Under scan noise, these are the most rounds of cutting and of closing cuts that cross, the most
// that close, and the further ones that only close. With half as many, or with charts divided for 8
// crossings whatever their size, time and charts were a tenth and a twentieth more (11 noisy
// meshes).
constexpr int kMostCuts = 12, kMostClosings = 10, kLastClosings = 4;
// Under scan noise a chart is divided if the banks of its cuts cross more often than both
// kMostCrossingsLeft times and once for kTrianglesACrossing triangles.
constexpr std::size_t kMostCrossingsLeft = 8, kTrianglesACrossing = 150;
// That decision is made after this number of cuts, or earlier if the chart is within the bound.
constexpr int kTelling = 2;
// Rounds of joining boundary loops of a union: of 5900 unions none succeeded after more.
constexpr int kMostJoints = 2;
// Charts of at least kManyTrianglesToCut that exceed the bound over more than kWideShare of their
// area were never saved by cuts to vertices (measured). If they have a hole, it may be what they
// close around.
constexpr std::size_t kManyTrianglesToCut = 1000;
constexpr double kWideShare = 0.04;
// Measured on 90 meshes: where charts exceed the bound by this factor around a small hole, joining
// the hole with the border saved 25 of 34, and a cut to a vertex none of 250.
constexpr double kHoleStretch = 1.1;
// Where the stretch did not fall by kSameStretch when kMostJoinsInVain holes were joined with the
// border one after the other, joining the rest never saved a chart of at least kFewTriangles (41
// charts of 814 meshes). In scans, charts have dozens of holes.
constexpr std::size_t kFewTriangles = 300;
constexpr int kMostJoinsInVain = 3;
constexpr double kSameStretch = 0.02;
// Charts beyond the bound whose border crosses itself more often were never saved. Of those whose
// border still crosses itself after cuts to single vertices, 10 of 700 were.
constexpr std::size_t kMostFirstCrossings = 3;

class ChartJob {
 public:
  ChartJob(const FlattenInput& input, Partition& partition, const ChartTask& task,
           ChartScratch& scratch)
      : input_(input),
        partition_(partition),
        scratch_(scratch),
        chart_(scratch.chart),
        task_(task) {}

  ChartOutcome run() {
    build(task_.triangles);
    ChartOutcome outcome;
    if (chart_.component_count > 1) {
      outcome.parts = component_parts();
      return outcome;
    }
    if (!beyond_cone()) {
      for (int cuts = 0;; ++cuts) {
        if (try_flatten(outcome)) return outcome;
        if (hopeless(cuts) || cuts_in_vain() || joins_in_vain() || tried_enough(cuts)) break;
        if (stretched_widely() && (cuts > 0 || chart_.loops.size() == 1)) break;
        if (!cut_open_timed(cuts)) break;
        build(task_.triangles);
      }
    }
    outcome.parts = task_.whole ? std::vector<std::uint8_t>(1, 0)
                                : halves(input_.topology, chart_, result_.offenders);
    outcome.failed = true;
    return outcome;
  }

 private:
  void build(std::span<const std::uint32_t> triangles) {
    chart_.build(input_.topology, partition_, triangles);
    chart_.take_density(input_.density);
    cone_ = normal_cone(input_.topology.normals, triangles);
  }

  bool try_flatten(ChartOutcome& outcome) {
    result_ = ParamResult{};
    const auto loops = static_cast<int>(chart_.loops.size());
    const bool flattens = loops > 0 && chart_.euler() == 2 - loops;  // genus 0
    return flattens && (only_darts() || cone_.angle < kOpenCone) && flatten(outcome);
  }

  // Whether the chart has genus 0 and all its boundary loops but one are small, or banks of cuts to
  // single vertices. Such loops need not be joined to anything.
  bool only_darts() const {
    return large_loops().size() <= 1 && chart_.euler() == 2 - static_cast<int>(chart_.loops.size());
  }

  std::vector<std::uint32_t> large_loops() const {
    std::vector<std::uint32_t> large;
    for (const std::uint32_t start : chart_.loops) {
      int edges = 0;
      bool cut = true;
      std::uint32_t h = start;
      do {
        cut = cut && partition_.seam(3 * chart_.triangles()[h / 3] + h % 3);
        h = chart_.next_border(h);
        ++edges;
      } while (h != start && (cut || edges <= kSmallHole));
      if (edges > (cut ? kLongestSlit : kSmallHole)) large.push_back(start);
    }
    return large;
  }

  // Joins boundary loops. Charts within an open cone are tried after each joint; others will not
  // flatten before all large loops are joined.
  bool join_loops() {
    std::vector<std::uint32_t> wanted;
    if (cone_.angle >= kOpenCone) wanted = large_loops();
    return atlas::join_loops(input_.topology, chart_, wanted, partition_);
  }

  // Cuts a seam that may help: from loop to loop, or to where curvature causes too much stretch.
  // Under scan noise, may instead close cuts whose banks cross. Returns false if there is nothing
  // to do.
  bool cut_open(int cuts) {
    const int closings = task_.whole || !noisy() ? task_.closings : kMostClosings;
    if (noisy() && result_.within_bound && !result_.injective && closings_ < closings &&
        darts_.close_crossed(input_.topology, chart_, crossings_to_undo(), partition_)) {
      ++closings_;
      return true;
    }
    // Otherwise the cuts just closed would be made again.
    if (closings_ > 0 && !only_darts()) return false;
    if (!only_darts() || hole_in_the_way(cuts)) return join_loops();
    if (cuts >= most_cuts() || result_.within_bound || result_.offenders.empty()) return false;
    cut_to_tips_ = true;
    return darts_.cut_to_border(input_.topology, chart_, result_.offenders, partition_);
  }

  bool cut_open_timed(int cuts) {
    if (chart_.triangles().size() < ParamWorkspace::timed_triangles) return cut_open(cuts);
    Stopwatch watch(thread_cpu_seconds);
    const bool any = cut_open(cuts);
    scratch_.cuts_cpu += watch.lap();
    return any;
  }

  bool noisy() const { return !input_.topology.calm_normals.empty(); }

  const std::vector<BorderCrossing>& crossings_left() const {
    return result_.stubborn_crossings.empty() ? result_.crossings : result_.stubborn_crossings;
  }

  std::vector<BorderCrossing> crossings_to_undo() const {
    return crossings_left().empty() ? turned_loops(chart_, result_.uvs) : crossings_left();
  }

  bool tried_enough(int cuts) const {
    if (task_.whole) return cuts >= kMostJoints;
    if (!noisy() || !only_darts()) return false;
    return cuts >= kMostCuts + (result_.within_bound ? kLastClosings : 0);
  }
  int most_cuts() const { return noisy() && !task_.whole ? kMostCuts : task_.cuts; }

  // Whether a chart beyond the bound can no longer be saved by cuts to single vertices. This does
  // not hold for charts with slits or holes: a terrain of terraces is one chart by such cuts, and
  // was five without them.
  bool cuts_in_vain() const {
    if (result_.within_bound || result_.uvs.empty() || chart_.loops.size() > 1) return false;
    return result_.crossings.size() > (cut_to_tips_ ? 0 : kMostFirstCrossings);
  }

  // Whether the last cuts have left the stretch as it was. Called once for each attempt.
  bool joins_in_vain() {
    if (noisy() || result_.within_bound || result_.uvs.empty()) return false;
    const double stretch = result_.distortion.stretch_999;
    in_vain_ = stretch > (1 - kSameStretch) * least_stretch_ ? in_vain_ + 1 : 0;
    least_stretch_ = std::min(least_stretch_, stretch);
    return in_vain_ >= kMostJoinsInVain && chart_.triangles().size() >= kFewTriangles;
  }

  // Whether the chart seems to close around a small hole.
  bool hole_in_the_way(int cuts) const {
    if (chart_.loops.size() < 2 || noisy()) return false;
    const bool far_beyond =
        result_.distortion.stretch_999 > kHoleStretch * input_.options.max_stretch;
    return far_beyond || (cuts == 0 && stretched_widely());
  }

  // Whether the banks of cuts cross in so many places that the chart is given up. Closing some
  // cuts hardly ever saved such a chart; neither did further cuts if it is still beyond the bound
  // (1 of 24; 160 meshes).
  bool hopeless(int cuts) const {
    const std::size_t crossings = std::max(result_.crossings.size(), crossings_left().size());
    return noisy() && (result_.within_bound || cuts >= kTelling) && !result_.injective &&
           crossings >
               std::max(kMostCrossingsLeft, chart_.triangles().size() / kTrianglesACrossing);
  }

  // Whether more than the surroundings of a few sharp vertices exceeds the bound.
  bool stretched_widely() const {
    if (noisy() || result_.within_bound || result_.uvs.empty()) return false;
    if (chart_.triangles().size() < kManyTrianglesToCut) return false;
    double beyond = 0;
    for (const std::uint32_t t : result_.offenders) {
      beyond += input_.topology.areas[chart_.triangles()[t]];
    }
    return beyond > kWideShare * chart_.surface_area(input_.topology);
  }

  bool beyond_cone() const {
    return input_.options.cone_degrees > 0 && chart_.triangles().size() > 1 &&
           cone_.angle > radians(input_.options.cone_degrees) * (1 + 1e-9);
  }

  std::vector<std::uint8_t> component_parts() const {
    std::vector<std::uint8_t> parts(chart_.component.size());
    for (std::size_t i = 0; i < parts.size(); ++i) {
      parts[i] = static_cast<std::uint8_t>(std::min(chart_.component[i], 255u));
    }
    return parts;
  }

  // In units of the uvs, which the density scales.
  double min_altitude() const {
    return kMinAltitude * std::sqrt(chart_.target_area(input_.topology));
  }

  param::FlattenOptions flatten_options() const {
    const ChartOptions& options = input_.options;
    param::FlattenOptions param;
    param.max_stretch = options.max_stretch;
    param.local = noisy() || task_.little;
    param.rough = noisy();
    param.max_planar_stretch =
        std::min(options.max_stretch,
                 options.preset == ChartPreset::fast ? kFastPlanarStretch : kPlanarStretch);
    param.axis = from_glm(glm::dvec3(to_glm(cone_.axis)));
    param.min_altitude = min_altitude();
    return param;
  }

  ParamResult solve(const LocalMesh& mesh) {
    ParamWorkspace& workspace = scratch_.workspace;
    param::FlattenOptions options = flatten_options();
    if (!task_.joined.empty())
      return param::join_flat_parts(mesh, {task_.joined, task_.little}, options, workspace);
    if (!input_.frames.empty())
      options.start.frames = [this](std::size_t i) {
        return input_.frames.at(input_.topology, chart_.triangles()[i]);
      };
    return param::flatten_disc(mesh, options, workspace);
  }

  // Lays a chart that unrolls flat, without calling the solver. Returns false if it does not
  // unroll, or would overlap itself.
  bool unroll() {
    const bool bent = cone_.angle > kFlatCone && chart_.density.empty();
    if (!bent || !lay_unrolled()) return false;
    if (!result_.injective && !slits_closed_ &&
        close_flat_slits(input_.topology, chart_, result_.uvs, partition_)) {
      slits_closed_ = true;
      build(chart_.triangles());
      if (!lay_unrolled()) return false;
    }
    return result_.injective;
  }

  bool lay_unrolled() {
    if (!unroll_chart(chart_, min_altitude(), result_.uvs)) return false;
    const LocalMesh mesh = chart_.mesh();
    result_.distortion = measure_distortion(mesh, result_.uvs);
    const double most = std::min(kPlanarStretch, input_.options.max_stretch);
    result_.within_bound =
        result_.distortion.stretch_999 <= most && result_.distortion.stretch_l2 <= most;
    if (!result_.within_bound) return false;
    const double root = std::sqrt(chart_.target_area(input_.topology));
    const Injectivity check = check_injectivity(mesh, result_.uvs, {.clearance = kTouching * root});
    result_.injective = check.injective && check.close.empty();
    return true;
  }

  bool flatten(ChartOutcome& outcome) {
    if (!unroll()) {
      const LocalMesh mesh = chart_.mesh();
      result_ = {};  // large, and no longer needed
      result_ = solve(mesh);
    }
    const bool single = chart_.triangles().size() == 1;
    if (!single && !(result_.injective && result_.within_bound)) return false;
    FlatChart& flat = outcome.flat;
    scratch_.border.clear();
    for (std::uint32_t h = 0; h < chart_.opposite.size(); ++h) {
      if (chart_.opposite[h] == kNoIndex) {
        scratch_.border.push_back({chart_.corners[h / 3][h % 3],
                                   chart_.corners[next_half_edge(h) / 3][next_half_edge(h) % 3]});
      }
    }
    flat.size = orient_for_packing(result_.uvs, scratch_.border).size;
    if (!single && !injective_as_turned()) return false;
    flat.uvs = std::move(result_.uvs);
    flat.corners = chart_.corners;
    flat.vertex = chart_.vertex;
    flat.cone = cone_;
    flat.distortion = result_.distortion;
    flat.planar = result_.planar;
    return true;
  }

  // Checks injectivity again after turning, which rounds: borders that touch, as those of boxes
  // that unroll, may now cross.
  bool injective_as_turned() {
    Injectivity check = check_injectivity(chart_.mesh(), result_.uvs);
    result_.injective = check.injective;
    if (!check.injective) result_.crossings = std::move(check.crossings);
    return check.injective;
  }

  const FlattenInput& input_;
  Partition& partition_;
  ChartScratch& scratch_;
  LocalChart& chart_;
  ChartTask task_;
  Darts darts_;
  int closings_ = 0;
  bool cut_to_tips_ = false;
  int in_vain_ = 0;  // attempts since the stretch fell
  double least_stretch_ = std::numeric_limits<double>::infinity();  // of all attempts
  bool slits_closed_ = false;  // slits that opened a chart that unrolls
  NormalCone cone_;
  ParamResult result_;  // of the last attempt
};

}  // namespace

ChartOutcome flatten_chart(const FlattenInput& input, Partition& partition, const ChartTask& task,
                           ChartScratch& scratch) {
  return ChartJob(input, partition, task, scratch).run();
}

}  // namespace atlas
