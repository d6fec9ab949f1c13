#include "libatlas/charts/flattening/absorb.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <queue>
#include <span>

#include "libatlas/charts/flattening/fitting_run.h"
#include "libatlas/charts/flattening/joint.h"
#include "libatlas/charts/merging/merge_options.h"
#include "libatlas/charts/mesh/border_weight.h"
#include "libatlas/core/degrees.h"
#include "libatlas/core/glm_bridge.h"
#include "libatlas/core/portable_math.h"

namespace atlas {
namespace {

// Limits on the work of joining charts: neighbours tried per chart, and the triangles of all unions
// as a multiple of the mesh's, which keeps the time linear.
struct Patience {
  std::size_t neighbours;
  // The least share of its rectangle that a union must fill, if both parts fill as much.
  double work, fill;
  // Charts of fewer triangles are tried, too, although they are not fragments.
  std::size_t few;
  std::size_t small_neighbours;  // neighbours tried for a small chart
};
// Of charts with fewer triangles than a cell the coarse mesh knows little more than the outline, so
// the decision to merge them is made here. A work of 1 left a tenth more charts, most of them
// around a large one (208 meshes), in 3 % less time; 16 removes hardly more.
constexpr Patience kSmooth{3, 4, 0.45, 60, 6};
constexpr Patience kFast{2, 0.25, 0.45, 0, 2};
// With ChartPreset::fast, unions that cost more than this share of the mesh's triangles are not
// tried: large cells leave a speck here and there beside a large chart, all of which would be
// flattened again. On a rough height field of a million triangles that took a sixth of the time.
// Fourteen models came out in as many charts, and eight noisy meshes in 9 % more, for 12 % less
// time.
constexpr double kFastUnion = 0.1;
constexpr Patience kBest{6, 4, 0.45, kNoIndex, 6};
// With a bound wider than the default one, all charts are tried, too: what the coarse mesh refuses,
// whose flattening has no barrier against flips, may lie flat within such a bound. spot, homer and
// the bunny came out in 3, 4 and 3 charts at a bound of 5 instead of 9, 9 and 4. With a work of 4,
// a ball with spikes is left with 41 charts at a bound of 2 instead of 28.
constexpr Patience kWide{6, 12, 0.45, kNoIndex, 6};
// Scan noise divides charts that need not be divided. A work of 3 with four neighbours, and only
// fragments and small charts tried, left 7 % more charts in a twelfth less time (60 noisy meshes).
constexpr Patience kNoisy{6, 4, 0.45, 200, 8};
// A cone limit leaves many small charts, which are cheap to try.
constexpr Patience kInCone{6, 3, 0.3, kNoIndex, 6};
// Charts below kSmallArea of their piece's area are small. To remove a small chart, the rectangle
// of the union may exceed the rectangles of both parts by kMostWaste of the piece's area.
constexpr double kSmallArea = 0.015, kMostWaste = 0.01;
constexpr double kWholeFill = 0.6;  // the share filled by a union of charts that are not fragments
// The share that a union fills never rose by more than 1 / kSureFill when it was solved for. Of
// 1600 unions this spares 260, with a seventh of the time, none of which would have succeeded (90
// meshes).
constexpr double kSureFill = 0.995;
// Charts are not joined if the two shapes of their common border differ by more than kMostMisfit of
// its length. Small charts have many neighbours to try, so their limit is stricter.
constexpr double kMostMisfit = 0.1, kMostSmallMisfit = 0.07;
// A union of at least kManyTrianglesToJoin is not tried if its parts overlap in kMostOverlap places
// before it is solved for. Of 13 000 unions 750 were like that; 15 of these succeeded, and they
// took 38 % of the time of all failures (208 meshes).
constexpr std::size_t kManyTrianglesToJoin = 250, kMostOverlap = 16;
// Where a whole border does not fit, the longest run of it that fits to kMostRunMisfit of its
// length is tried. Runs below kLeastRun of the smaller chart's border would leave about as much
// seam as before.
constexpr double kMostRunMisfit = 0.03, kLeastRun = 0.1;
// If a union has more than kLittle times the triangles of its smaller part, the larger part keeps
// its uvs except around the smaller one. That costs half as much per triangle, and saves a quarter
// of the time for all unions.
constexpr std::size_t kLittle = 10;
constexpr double kLittleWork = 0.5;

// The L2 stretch that any union may have, as when cells are merged. With the limit of the default
// bound, rough surfaces came out in more charts, the wider the bound was.
double largest_l2(double max_stretch) {
  const double usual = merge_options(ChartOptions{}.max_stretch).limits.stretch_l2;
  return std::max(usual, merge_options(max_stretch).limits.stretch_l2);
}

// How many times the default bound's excess over 1 this bound has. Two charts may have so many
// times the usual misfit: a spike lies in a hole of its neighbour and can only be pressed flat into
// it; with the usual misfit a ball with spikes was left with 79 of them at a bound of 5, and with
// 45 at a bound of 2. Their union may fill so many times less of its rectangle.
double room_in(double max_stretch) {
  return std::max(1.0, (max_stretch - 1) / (ChartOptions{}.max_stretch - 1));
}

class Absorber {
 public:
  Absorber(const AbsorbInput& input, std::vector<FlatChart>& charts)
      : input_(input),
        topology_(input.flatten.topology),
        charts_(charts),
        patience_(choose_patience(input.flatten.options)),
        most_l2_(largest_l2(input.flatten.options.max_stretch)),
        room_(room_in(input.flatten.options.max_stretch)),
        seam_worth_(merge_options(input.flatten.options.max_stretch).seam_worth),
        crease_angle_(radians(input.flatten.options.crease_degrees)),
        work_(patience_.work * double(topology_.triangle_count())),
        most_cost_(input.flatten.options.preset == ChartPreset::fast
                       ? kFastUnion * double(all_triangles())
                       : std::numeric_limits<double>::infinity()) {
    auto& label = input_.partition.chart;
    for (std::uint32_t k = 0; k < charts_.size(); ++k) {
      for (const std::uint32_t t : charts_[k].triangles) label[t] = k;
    }
  }

  void run(const Context& context) {
    using Entry = std::pair<std::size_t, std::uint32_t>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
    measure_areas();
    outlines_.resize(charts_.size());
    for (std::uint32_t k = 0; k < charts_.size(); ++k) {
      candidate_.push_back(worth_a_try(k));
      if (candidate_[k]) queue.push({charts_[k].triangles.size(), k});
    }
    while (!queue.empty() && !context.cancelled() && work_ > 0) {
      const auto [size, k] = queue.top();
      queue.pop();
      if (charts_[k].triangles.size() != size) continue;  // the chart has changed since
      const std::uint32_t into = absorb(k);
      if (into != kNoIndex && candidate_[into]) {
        queue.push({charts_[into].triangles.size(), into});
      }
    }
    std::erase_if(charts_, [](const FlatChart& chart) { return chart.triangles.empty(); });
  }

 private:
  Patience choose_patience(const ChartOptions& options) const {
    if (options.cone_degrees > 0) return kInCone;
    if (!topology_.calm_normals.empty()) return kNoisy;
    if (options.preset == ChartPreset::fast) return kFast;
    if (room_in(options.max_stretch) > 1) return kWide;
    return options.preset == ChartPreset::best ? kBest : kSmooth;
  }

  // The triangles of the whole mesh, of which these charts may be a piece.
  std::size_t all_triangles() const {
    return std::max(topology_.whole_triangles, topology_.triangle_count());
  }
  double piece_area(std::uint32_t k) const { return piece_area_[charts_[k].piece(topology_)]; }
  double piece_target(std::uint32_t k) const { return piece_target_[charts_[k].piece(topology_)]; }
  bool small(std::uint32_t k) const { return area_[k] < kSmallArea * piece_area(k); }

  bool worth_a_try(std::uint32_t k) const {
    const FlatChart& chart = charts_[k];
    const std::size_t size = chart.triangles.size();
    if (size < patience_.few || small(k)) return true;
    return chart.fragment && !topology_.calm_normals.empty();
  }

  std::uint32_t absorb(std::uint32_t k) {
    const std::vector<BorderEdge> border =
        find_border(topology_, input_.partition, charts_[k].triangles, k);
    const std::vector<ChartNeighbour> neighbours = find_neighbours(border);
    const std::size_t most = small(k) ? patience_.small_neighbours : patience_.neighbours;
    for (std::size_t i = 0; i < std::min(neighbours.size(), most); ++i) {
      if (join(k, neighbours[i])) return neighbours[i].chart;
    }
    return small(k) || room_ > 1 ? attach(k, neighbours) : kNoIndex;
  }

  bool may_fit_cone(const FlatChart& a, const FlatChart& b) const {
    const double limit = radians(input_.flatten.options.cone_degrees);
    if (limit <= 0) return true;
    const double between =
        portable::acos(std::clamp(glm::dot(to_dvec(a.cone.axis), to_dvec(b.cone.axis)), -1.0, 1.0));
    return between <= 2 * limit && std::max(a.cone.angle, b.cone.angle) <= limit;
  }

  // Joins a small chart that fits no neighbour along its whole border along the longest run of the
  // border that fits, with a seam along the rest. This is how tips come off as petals.
  std::uint32_t attach(std::uint32_t k, std::span<const ChartNeighbour> neighbours) {
    struct Run {
      double length;
      const ChartNeighbour* neighbour;
      std::vector<BorderEdge> edges;
    };
    std::vector<Run> runs;
    double whole = 0;
    for (const ChartNeighbour& n : neighbours) {
      std::vector<BorderEdge> edges = find_fitting_run(
          topology_, {charts_[k], charts_[n.chart]}, n.edges, kMostRunMisfit * density(k, n.chart));
      whole += length_of(n.edges);
      if (edges.size() == n.edges.size()) continue;
      runs.push_back({length_of(edges), &n, std::move(edges)});
    }
    for (Run& run : runs) run.length = std::round(kBorderParts * run.length / whole);
    std::stable_sort(runs.begin(), runs.end(),
                     [](const Run& a, const Run& b) { return a.length > b.length; });
    for (std::size_t i = 0; i < std::min(runs.size(), patience_.small_neighbours); ++i) {
      if (!(runs[i].length >= kLeastRun * kBorderParts)) break;
      if (join(k, *runs[i].neighbour, runs[i].edges)) return runs[i].neighbour->chart;
    }
    return kNoIndex;
  }

  // Whether two charts may become one, as far as can be known without trying.
  bool promising(std::uint32_t k, const ChartNeighbour& neighbour, const Joint& joint) {
    const FlatChart &a = charts_[k], &b = charts_[neighbour.chart];
    const double most = small(k) ? kMostSmallMisfit : kMostMisfit;
    const double length = density(k, neighbour.chart);
    if (joint.motion().misfit > most * room_ * length) return false;
    const double covered = a.distortion.uv_area + b.distortion.uv_area;
    const Outline &around_a = outline(k), &around_b = outline(neighbour.chart);
    const Extent extent{covered / kSureFill, joint.box(around_a, around_b)};
    if (!fills(k, neighbour.chart, extent, 2 * kMostWaste)) return false;
    const auto most_overlap = std::size_t(double(kMostOverlap) * std::min(room_, 1e6));
    return joint.triangle_count() < kManyTrianglesToJoin ||
           joint.overlap(around_a, around_b, most_overlap) < most_overlap;
  }

  // Returns the chart's outline, which is kept until the chart changes.
  const Outline& outline(std::uint32_t k) {
    Outline& outline = outlines_[k];
    if (outline.edges.empty()) outline = outline_of(topology_, input_.partition, charts_[k]);
    return outline;
  }

  // Joins along the whole border with the neighbour. Tried once for each size of the two.
  bool join(std::uint32_t k, const ChartNeighbour& neighbour) {
    const std::size_t size =
        charts_[k].triangles.size() + charts_[neighbour.chart].triangles.size();
    std::size_t& failed_size = failed_[std::minmax(k, neighbour.chart)];
    if (failed_size == size) return false;
    failed_size = size;
    return join(k, neighbour, neighbour.edges);
  }

  bool join(std::uint32_t k, const ChartNeighbour& neighbour, std::span<const BorderEdge> glue) {
    const std::uint32_t into = neighbour.chart;
    FlatChart &a = charts_[k], &b = charts_[into];
    if (!may_fit_cone(a, b)) return false;
    const Joint joint(topology_, {a, b}, glue);
    if (!promising(k, {into, 0, glue}, joint)) return false;
    const std::size_t size = joint.triangle_count();
    const bool little = size > kLittle * std::min(a.triangles.size(), b.triangles.size());
    const double cost = (little ? kLittleWork : 1) * double(size);
    if (cost > most_cost_) return false;
    work_ -= cost;
    std::vector<std::uint8_t> seams;
    for (const FlatChart* chart : {&a, &b}) {
      for (const std::uint32_t t : chart->triangles) seams.push_back(input_.partition.seams[t]);
    }
    for (const std::uint32_t t : a.triangles) input_.partition.chart[t] = into;
    if (glue.size() < neighbour.edges.size()) sew(neighbour.edges, glue);
    std::vector<std::uint32_t> both = joint.triangles();
    const std::vector<Vec2d> joined = joint.uvs();
    ChartOutcome outcome = flatten_chart(
        input_.flatten, input_.partition,
        {.triangles = both, .cuts = 0, .joined = joined, .little = little, .whole = true},
        input_.scratch);
    outcome.flat.triangles = std::move(both);
    if (outcome.parts.empty() && is_better(outcome.flat, k, {into, 0, glue})) {
      outcome.flat.fragment = a.fragment && b.fragment;
      b = std::move(outcome.flat);
      a = FlatChart{};
      area_[into] += area_[k];
      target_[into] += target_[k];
      outlines_[k] = outlines_[into] = {};
      return true;
    }
    for (const std::uint32_t t : a.triangles) input_.partition.chart[t] = k;
    std::size_t i = 0;
    for (const FlatChart* chart : {&a, &b}) {
      for (const std::uint32_t t : chart->triangles) input_.partition.seams[t] = seams[i++];
    }
    return false;
  }

  // Leaves a seam along the part of a border that is not glued.
  void sew(std::span<const BorderEdge> border, std::span<const BorderEdge> glue) {
    for (const BorderEdge& edge : border) {
      input_.partition.cut(edge.half_edge);
      input_.partition.cut(topology_.opposite[edge.half_edge]);
    }
    for (const BorderEdge& edge : glue) {
      input_.partition.close(edge.half_edge);
      input_.partition.close(topology_.opposite[edge.half_edge]);
    }
  }

  // Whether a union is better than its parts. It must not cost more stretch than the seam that it
  // saves is worth. A union may stretch as much as one of its parts, since on rough surfaces every
  // chart exceeds the limit, and none could be joined (a third fewer charts on ten rough meshes).
  bool is_better(const FlatChart& both, std::uint32_t k, const ChartNeighbour& neighbour) const {
    const std::uint32_t into = neighbour.chart;
    const FlatChart &a = charts_[k], &b = charts_[into];
    const double most_l2 = std::max({most_l2_, a.distortion.stretch_l2, b.distortion.stretch_l2});
    if (both.distortion.stretch_l2 > most_l2) return false;
    const Extent extent{both.distortion.uv_area, both.box_area()};
    if (!fills(k, into, extent, kMostWaste)) return false;
    const double worth = seam_worth_ * seam_weight(neighbour.edges) * std::sqrt(piece_area(k));
    return (area_[k] + area_[into]) * both.excess() <=
           area_[k] * a.excess() + area_[into] * b.excess() + worth;
  }

  struct Extent {
    double covered, box;
  };
  // Whether a union of that extent fills enough of its rectangle.
  bool fills(std::uint32_t k, std::uint32_t into, const Extent& extent, double most_waste) const {
    const FlatChart &a = charts_[k], &b = charts_[into];
    const double least = a.fragment || b.fragment ? std::min({patience_.fill, fill(a), fill(b)})
                                                  : kWholeFill / room_;
    if (!(extent.covered < least * extent.box)) return true;
    const double waste = extent.box - a.box_area() - b.box_area();
    return (small(k) || small(into)) && waste <= most_waste * piece_target(k);
  }

  static double fill(const FlatChart& chart) {
    const double box = chart.box_area();
    return box > 0 ? chart.distortion.uv_area / box : 1;
  }

  // Creases count less, since they hide a seam.
  double seam_weight(std::span<const BorderEdge> edges) const {
    double weight = 0;
    for (const BorderEdge& edge : edges)
      weight += border_weight(topology_, edge.half_edge, crease_angle_);
    return weight;
  }

  void measure_areas() {
    const std::span<const float> densities = input_.flatten.density;
    piece_area_.assign(topology_.component_count, 0);
    piece_target_ = piece_area_;
    for (const FlatChart& chart : charts_) {
      double area = 0, target = 0;
      for (const std::uint32_t t : chart.triangles) {
        const double density = densities.empty() ? 1 : densities[t];
        area += topology_.areas[t];
        target += topology_.areas[t] * density * density;
      }
      area_.push_back(area);
      target_.push_back(target);
      piece_area_[chart.piece(topology_)] += area;
      piece_target_[chart.piece(topology_)] += target;
    }
  }

  // The mean density of two charts: how many times as long lengths are in uv as on the surface.
  double density(std::uint32_t k, std::uint32_t into) const {
    if (input_.flatten.density.empty()) return 1;
    return std::sqrt((target_[k] + target_[into]) / (area_[k] + area_[into]));
  }

  const AbsorbInput& input_;
  const Topology& topology_;
  std::vector<FlatChart>& charts_;
  Patience patience_;
  double most_l2_, room_, seam_worth_;
  double crease_angle_;
  double work_, most_cost_;  // what is left for all unions, and the most that one may cost
  // One per chart: whether it is tried by itself, also after it has taken in others.
  std::vector<std::uint8_t> candidate_;
  std::vector<double> area_;  // one per chart: surface area
  std::vector<double> piece_area_;
  // The areas that uvs are to have: the same times densities squared.
  std::vector<double> target_, piece_target_;
  std::vector<Outline> outlines_;  // one per chart; empty: not known
  // For each pair of charts, the number of triangles of the union that was tried last. The same
  // union would fail again.
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::size_t> failed_;
};

}  // namespace

void absorb_charts(const AbsorbInput& input, std::vector<FlatChart>& charts,
                   const Context& context) {
  Absorber(input, charts).run(context);
}

}  // namespace atlas
